// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>

#include "flight/repeat.hpp"
#include "viewer/flight_watch.hpp"

namespace rosflight::apps {

/// What a program with a server adds to ./rosflight fly.
struct Viewers {
  /// Starts what --view asks for. @throws config::Error.
  /// @param hold  the simulated pilot waits with arming for a viewer.
  std::function<std::unique_ptr<viewer::FlightWatch>(const web::server::Access& access, bool hold)>
      watch;
  /// What --repeat asks for: does what viewers did. @param recorded  outlives the commander.
  std::function<std::unique_ptr<flight::Commander>(const flight::RecordedFlight& recorded)> repeat;
};

}  // namespace rosflight::apps
