// SPDX-License-Identifier: BSD-3-Clause
#include "ros/rosplane/src/controller_parameters.hpp"

namespace rosflight::ros_plane {
namespace {

using List = std::vector<WingParameter>;
constexpr double kMost = 100.0;
using autonomy::kRadPerDeg;

/// kp, ki, kd under `prefix`; without a derivative only the first two.
template <class Of>
void gains(List& list, const std::string& prefix, const std::string& text, Of of,
           bool derivative = true) {
  list.push_back(
      over(prefix + "_kp", 0.0, kMost, text, [of](auto& c) -> auto& { return of(c).kp; }));
  list.push_back(over(prefix + "_ki", 0.0, kMost, text + ", integral",
                      [of](auto& c) -> auto& { return of(c).ki; }));
  if (!derivative) return;
  list.push_back(over(prefix + "_kd", 0.0, kMost, text + ", derivative",
                      [of](auto& c) -> auto& { return of(c).kd; }));
}

void add_gains(List& list) {
  gains(
      list, "c", "course to bank", [](auto& c) -> auto& { return c.flight.controller.course; },
      false);
  gains(list, "r", "bank to aileron at cruise",
        [](auto& c) -> auto& { return c.flight.controller.roll; });
  gains(list, "p", "pitch to elevator at cruise",
        [](auto& c) -> auto& { return c.flight.controller.pitch; });
  gains(list, "a_t", "airspeed to throttle, successive loops",
        [](auto& c) -> auto& { return c.flight.controller.successive_loops.airspeed; });
  gains(list, "a", "height to climb angle, successive loops",
        [](auto& c) -> auto& { return c.flight.controller.successive_loops.height; });
  gains(list, "e", "energy to throttle, total energy",
        [](auto& c) -> auto& { return c.flight.controller.total_energy.energy; });
  gains(list, "l", "balance to climb angle, total energy",
        [](auto& c) -> auto& { return c.flight.controller.total_energy.balance; });
  list.push_back(over("y_kr", 0.0, 10.0, "yaw rate to rudder at cruise [s]",
                      [](auto& c) -> auto& { return c.flight.controller.yaw_damper_s; }));
  list.push_back(over("y_pwo", 0.0, 50.0, "corner of the yaw damper's washout [rad/s]",
                      [](auto& c) -> auto& { return c.flight.controller.yaw_washout_rad_s; }));
}

void add_limits(List& list) {
  list.push_back(over(
      "max_roll", 5.0, 60.0, "[deg]",
      [](auto& c) -> auto& { return c.flight.controller.max_roll_rad; }, kRadPerDeg));
  list.push_back(over(
      "max_pitch", 5.0, 45.0, "[deg]",
      [](auto& c) -> auto& { return c.flight.controller.max_pitch_rad; }, kRadPerDeg));
  list.push_back(over("max_t", 0.1, 1.0, "most throttle",
                      [](auto& c) -> auto& { return c.flight.controller.max_throttle; }));
  list.push_back(over("trim_t", 0.0, 1.0, "throttle of level flight at cruise",
                      [](auto& c) -> auto& { return c.flight.controller.throttle_cruise; }));
  WingParameter error =
      over("max_alt_error", 1.0, 200.0, "farther away a height counts as this [m]",
           [](auto& c) -> auto& { return c.flight.controller.total_energy.max_height_error_m; });
  error.set = [](WingConfig& c, double x) {
    c.flight.controller.total_energy.max_height_error_m = x;
    c.flight.controller.successive_loops.max_height_error_m = x;
  };
  list.push_back(error);
  list.push_back(over("mass", 0.1, 1000.0, "[kg]",
                      [](auto& c) -> auto& { return c.flight.controller.airframe.mass_kg; }));
  WingParameter gravity = over("gravity", 9.0, 10.0, "[m/s^2]", [](auto& c) -> auto& {
    return c.flight.controller.airframe.gravity_m_s2;
  });
  gravity.set = [](WingConfig& c, double x) {
    c.flight.controller.airframe.gravity_m_s2 = x;
    c.flight.controller.total_energy.gravity_m_s2 = x;
  };
  list.push_back(gravity);
}

void add_takeoff(List& list) {
  list.push_back(over("alt_toz", 0.5, 500.0, "height of the take-off without a path manager [m]",
                      [](auto& c) -> auto& { return c.zones.takeoff_m; }));
  list.push_back(over("alt_hz", 0.5, 500.0, "below the height wanted: end of that climb [m]",
                      [](auto& c) -> auto& { return c.zones.hold_m; }));
  list.push_back(over("max_takeoff_throttle", 0.1, 1.0, "most throttle until airborne",
                      [](auto& c) -> auto& { return c.max_takeoff_throttle; }));
  list.push_back(over(
      "cmd_takeoff_pitch", 0.0, 30.0, "once fast enough, without a path manager [deg]",
      [](auto& c) -> auto& { return c.flight.takeoff.pitch_rad; }, kRadPerDeg));
  list.push_back(flag("roll_command_override", "phi_c of the command instead of the course loop",
                      [](auto& c) -> auto& { return c.roll_override; }));
  list.push_back(flag("pitch_command_override", "theta_c of the command instead of the height loop",
                      [](auto& c) -> auto& { return c.pitch_override; }));
}

}  // namespace

std::vector<WingParameter> controller_parameters() {
  List list{over("controller_output_frequency", 10.0, 1000.0, "most commands a second [Hz]",
                 [](auto& c) -> auto& { return c.rate_Hz; })};
  add_gains(list);
  add_limits(list);
  add_takeoff(list);
  return list;
}

}  // namespace rosflight::ros_plane
