// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>

#include "flight/flight_setup.hpp"

namespace rosflight::apps {

/// Flies one seed after the other, writes a row for each to `file` and prints what became of them.
/// Ctrl-C ends it with the rows kept.
/// @returns the exit code: 0 if every mission was done. @throws config::Error bad input.
int campaign_command(const flight::FlightChoice& choice, const std::string& seeds,
                     const std::filesystem::path& file, std::ostream& out, std::ostream& err);

}  // namespace rosflight::apps
