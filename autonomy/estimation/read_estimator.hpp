// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/estimation/estimator_config.hpp"
#include "config/strict_yaml.hpp"
#include "config/table_fwd.hpp"

namespace rosflight::autonomy::estimation {

/// The parameters of the section `autonomy.estimator`: config/table.hpp.
config::Table<EstimatorConfig> parameters();

/// Reads the section `autonomy.estimator` of a vehicle file over `defaults`; docs/autonomy-keys.md
/// lists the keys, each may be absent. Throws config::Error. Finishes the section.
EstimatorConfig read_estimator(const config::Section& section, const EstimatorConfig& defaults);

}  // namespace rosflight::autonomy::estimation
