// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <string>

#include "flight/error_statistics.hpp"
#include "flight/flight.hpp"

namespace rosflight::flight {

/// How two flights of one setup differ, the body moved by two engines: true states at the same times.
struct PhysicsComparison {
  ErrorStatistics position_m;
  ErrorStatistics attitude_rad;                 ///< While both are in the air.
  std::array<double, 2> tracking_rms_m{};       ///< NaN: the flight followed nothing.
  std::array<double, 2> touchdown_speed_m_s{};  ///< NaN: it is not down.
  std::array<bool, 2> success{};
  double duration_s{};  ///< Duration of the shorter flight.
};

/// Called with the time and the distance of the true positions [m] after each step of both flights.
using DistanceSink = std::function<void(sim::Time, double)>;

/// Flies `choice` twice at once, as it is and with `physics`, until both flights are finished or `end` is reached.
/// @throws as FlightSetup and Flight.
PhysicsComparison compare_physics(const FlightChoice& choice, const std::string& physics,
                                  sim::Time end = sim::Time::max(), const DistanceSink& sink = {});

}  // namespace rosflight::flight
