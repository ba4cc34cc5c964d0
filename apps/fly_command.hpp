// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>

#include "flight/fly.hpp"
#include "viewer/flight_watch.hpp"

namespace rosflight::apps {

/// `./rosflight fly`: flies, leaves a flight folder, prints the result to `out` (`json`: as one
/// JSON object) and progress to `err`.
/// @param watch  may be none. @param log_sha256  takes the hash of the log; may be none.
/// @returns 0, or 1 if the mission failed or the emulated autopilot did. @throws as flight::fly().
int fly_command(flight::FlyOptions options, bool json, std::ostream& out, std::ostream& err,
                viewer::FlightWatch* watch = nullptr, std::string* log_sha256 = nullptr);

}  // namespace rosflight::apps
