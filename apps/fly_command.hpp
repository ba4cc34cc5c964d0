// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>

#include "flight/fly.hpp"

namespace rosflight::apps {

/// `./rosflight fly`: flies, leaves a flight folder, prints the result to `out` (`json`: as one
/// JSON object) and progress to `err`.
/// @returns 0, or 1 if the mission failed or the emulated autopilot did. @throws as flight::fly().
int fly_command(flight::FlyOptions options, bool json, std::ostream& out, std::ostream& err);

}  // namespace rosflight::apps
