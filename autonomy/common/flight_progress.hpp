// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/flight_events.hpp"

namespace rosflight::autonomy {

/// How far a flight is after one step: the part of the output that every FlightManager has.
template <typename Phase>
struct FlightProgress {
  Phase phase{Phase::kDisarmed};
  std::size_t waypoint{};  ///< Target of the present leg, counted from 0.
  bool mission_done{};     ///< The last waypoint was passed.
  bool landed{};           ///< Once in this flight.
  bool request_disarm{};   ///< It stands after the landing.
  FlightEvents events{};   ///< Events of this step.
};

}  // namespace rosflight::autonomy
