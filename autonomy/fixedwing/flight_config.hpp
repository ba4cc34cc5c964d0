// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/battery_watch.hpp"
#include "autonomy/fixedwing/controller.hpp"
#include "autonomy/fixedwing/glide.hpp"
#include "autonomy/fixedwing/landing.hpp"
#include "autonomy/fixedwing/path_follower.hpp"
#include "autonomy/fixedwing/path_manager.hpp"

namespace rosflight::autonomy::fixedwing {

struct TakeoffConfig {
  double height_m{40.0};               ///< Above where it stands.
  double rotate_m_s{11.5};             ///< Airspeed at which the nose comes up,
  double pitch_rad{8.0 * kRadPerDeg};  ///< to this.
  double ramp_s{1.0};                  ///< Throttle from none to all.
  double airborne_m{4.0};              ///< Above the start: the take-off is a climb.
  double timeout_s{25.0};              ///< Not airborne after this: the take-off has failed.
  double interrupted_s{5.0};           ///< The same on the ground after so long without control.
  double margin_m{3.0};                ///< The climb ends this much below the height.
};

struct SafetyConfig {
  double dead_reckoning_s{30.0};  ///< A position without aiding is followed this long.
  double position_wait_s{120.0};  ///< From the last aided position; then it comes down.
  double descent_m_s{1.5};        ///< Sink of a descent without a position.
  double return_height_m{60.0};   ///< Above the start.
  double motor_out_s{3.0};        ///< Full throttle and losing energy for this long.
  double motor_out_m_s{0.5};      ///< Energy lost per weight, as a sink rate.
  double glide_m_s{14.0};         ///< Airspeed that sinks least, and some.
  double glide_ratio{8.5};        ///< Distance per height at that airspeed, in still air.
  double straight_below_m{20.0};  ///< A glide does not turn any more.
  double max_range_m{8.0};        ///< Readings of the range sensor beyond count as none.
};

/// Settings of a whole flight of a fixed wing; the keys of section `autonomy` in a vehicle file.
struct FlightConfig {
  PlannerConfig plan{};
  FollowerConfig follower{};
  ControllerConfig controller{};
  TakeoffConfig takeoff{};
  LandingConfig landing{};
  SafetyConfig safety{};
  BatteryConfig battery{};
  double lead_s{0.5};  ///< Lead time on the path (PathManager).
};

}  // namespace rosflight::autonomy::fixedwing
