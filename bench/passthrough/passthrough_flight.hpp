// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "bench/passthrough/roll_triangle.hpp"

namespace rosflight::bench::passthrough {

/// The demonstration of the ROSflight 2.0 paper: the companion closes the attitude loops over the link.
struct PassthroughPlan {
  std::string board{"in_process"};  ///< As flight::FlightChoice has it.
  std::string link{"cable"};
  double duration_s{20.0};
  double amplitude_rad{0.2};
  double period_s{4.0};
  double height_m{5.0};
  /// The companion sends the attitude of its own estimator to the firmware's filter, as it does in every flight of
  /// `fly`. Otherwise that filter has gyro and accelerometer alone, as in the paper.
  bool shares_attitude{true};
};

struct PassthroughResult {
  std::vector<Row> rows;    ///< One for each step of the world.
  double commands_hz{};     ///< Sent while the wave was followed.
  double attitudes_hz{};    ///< Received.
  std::uint64_t dropped{};  ///< Commands that the link did not take.
  double height_min_m{},
      height_max_m{};  ///< The true altitude above ground, while the wave was followed.
};

/// Flies the default multirotor with the mixer of its geometry: in each step of 2.5 ms the companion answers the newest attitude that
/// has arrived with a pass-through command (OFFBOARD_CONTROL, mode 0): thrust [N] and torques [N m]. The firmware
/// mixes, and estimates the attitude. Roll follows a triangle wave, pitch and heading are held.
///
///     torque = J w^2 (e + integral of e / T) + 2 z w J (rate setpoint - rate)             (1)
///     thrust = m (g + k (h_set - h) - d climb) / cos(tilt)                                  (2)
///
/// (1) by autonomy::multirotor::Controller, in its mode of angles and thrust; h of (2) by the estimator of the
/// companion, 100 times a second. Bytes take their time on the link. The companion runs at the start of a step, so an
/// attitude waits up to 2.5 ms for it.
/// @throws std::exception  the vehicle did not arm, a model of the board complained, or the flight failed.
PassthroughResult fly_passthrough(const PassthroughPlan& plan);

}  // namespace rosflight::bench::passthrough
