// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "config/table_fwd.hpp"
#include "sim/environment/environment.hpp"

namespace rosflight::sim {

/// The parameters of the section `environment` but `start_utc`: config/table.hpp.
config::Table<EnvironmentParameters> environment_parameters();

}  // namespace rosflight::sim
