// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <optional>
#include <string>

#include "flight/fly.hpp"
#include "log/log_observer.hpp"

namespace rosflight::apps {

/// A view of the running flight, for programs that have one.
class FlightWatch {
 public:
  virtual ~FlightWatch() = default;
  virtual log::LogObserver& observer() = 0;
  virtual flight::Commander& commander() = 0;
  /// The flight has ended and its folder is written; returns when nobody wants to look any more, or
  /// somebody wants another flight. @returns its mission, empty: the same; nothing: none.
  virtual std::optional<std::string> stay(const flight::FlightSummary& summary) = 0;
};

/// `./rosflight fly`: flies, leaves a flight folder, prints the result to `out` (`json`: as one
/// JSON object) and progress to `err`.
/// @param watch  may be none. @param log_sha256  takes the hash of the log; may be none.
/// @returns 0, or 1 if the mission failed or the emulated autopilot did. @throws as flight::fly().
int fly_command(flight::FlyOptions options, bool json, std::ostream& out, std::ostream& err,
                FlightWatch* watch = nullptr, std::string* log_sha256 = nullptr);

}  // namespace rosflight::apps
