// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <optional>
#include <string>

#include "flight/flight.hpp"

namespace rosflight::viewer {

/// How a simulation goes on.
struct Pace {
  bool paused{false};
  int steps{0};       ///< While paused: still to be done.
  double speed{1.0};  ///< Times real time.
  /// Fly again: this mission, or the same one if empty.
  std::optional<std::string> reset;
};

/// Understands a change that a viewer steers: those of flight::parse_change(), and
///
///     pause | resume
///     step N            pauses after N steps
///     speed X           times real time, 0.01 to 100
///     reset [MISSION]   ends the flight and begins another
///
/// @returns what does it. `flight` and `pace` must live as long. @throws config::Error
std::function<void()> parse_simulation_change(const std::string& text, flight::Flight& flight,
                                              Pace& pace);

/// The mission in "reset MISSION", empty for "reset"; nothing for another text.
/// @param choice  of the flight before. @throws config::Error  it cannot be flown.
std::optional<std::string> parse_reset(const std::string& text, flight::FlightChoice choice);

}  // namespace rosflight::viewer
