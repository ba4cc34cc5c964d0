// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <CLI/CLI.hpp>

#include "apps/sil/sil.hpp"

namespace rosflight::apps {

/// Adds the command `sil` to a program. Parsing fills `options`, which must outlive `app`; what
/// runs is for the caller: `if (*add_sil(app, options)) return sil_command(options, std::cout);`
CLI::App* add_sil(CLI::App& app, SilOptions& options);

}  // namespace rosflight::apps
