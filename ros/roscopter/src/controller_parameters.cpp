// SPDX-License-Identifier: BSD-3-Clause
#include "ros/roscopter/src/controller_parameters.hpp"

#include <string>

#include "base/constants.hpp"

namespace rosflight::roscopter {
namespace {

using Parameter = ros_common::LiveParameter<Tuning>;
using List = std::vector<Parameter>;

constexpr double kDegPerRad = 1.0 / autonomy::kRadPerDeg;
constexpr double kGravity_m_s2 = base::kStandardGravity_m_s2;

/// A number, `unit` times the one inside.
template <class Of>
void add(List& list, const char* name, double least, double most, const char* text, double unit,
         Of of) {
  list.push_back({name, least, most, text, [of, unit](const Tuning& t) { return unit * of(t); },
                  [of, unit](Tuning& t, double value) { of(t) = value / unit; }});
}

void add_loops(List& list) {
  using ros_common::add_gains;
  const auto loop = [&list](const char* prefix, const char* text, double unit, auto of) {
    add_gains(list, prefix, text, unit, of);
  };
  const char* torque = "from an angle [rad] to a torque [N m]";
  loop("roll_to_torque", torque, 1.0, [](auto& t) -> auto& { return t.controller.roll_to_torque; });
  loop("pitch_to_torque", torque, 1.0,
       [](auto& t) -> auto& { return t.controller.pitch_to_torque; });
  loop("yaw_to_torque", torque, 1.0, [](auto& t) -> auto& { return t.controller.yaw_to_torque; });
  const char* rate = "from a rate [rad/s] to a torque [N m]";
  loop("roll_rate_to_torque", rate, 1.0,
       [](auto& t) -> auto& { return t.controller.roll_rate_to_torque; });
  loop("pitch_rate_to_torque", rate, 1.0,
       [](auto& t) -> auto& { return t.controller.pitch_rate_to_torque; });
  loop("yaw_rate_to_torque", rate, 1.0,
       [](auto& t) -> auto& { return t.controller.yaw_rate_to_torque; });
  loop("yaw_to_rate", "from the heading [rad] to a yaw rate [rad/s]", 1.0,
       [](auto& t) -> auto& { return t.controller.heading_to_rate; });
  const char* speed = "from a velocity [m/s] to an acceleration in units of gravity";
  loop("vel_n_to_accel", speed, 1.0 / kGravity_m_s2,
       [](auto& t) -> auto& { return t.controller.velocity_horizontal; });
  loop("vel_e_to_accel", speed, 1.0 / kGravity_m_s2,
       [](auto& t) -> auto& { return *t.controller.velocity_east; });
  loop("vel_d_to_accel", speed, 1.0 / kGravity_m_s2,
       [](auto& t) -> auto& { return t.controller.velocity_vertical; });
  const char* place = "from a position [m] to a velocity [m/s]";
  loop("pos_n_to_vel", place, 1.0,
       [](auto& t) -> auto& { return t.controller.position_horizontal; });
  loop("pos_e_to_vel", place, 1.0, [](auto& t) -> auto& { return *t.controller.position_east; });
  loop("pos_d_to_vel", place, 1.0, [](auto& t) -> auto& { return t.controller.position_vertical; });
}

void add_limits(List& list) {
  add(list, "mass", 0.01, 1000.0, "[kg]", 1.0,
      [](auto& t) -> auto& { return t.controller.mass_kg; });
  add(list, "gravity", 9.0, 10.0, "[m/s^2]", 1.0,
      [](auto& t) -> auto& { return t.controller.gravity_m_s2; });
  add(list, "tau", 0.001, 10.0, "of derivatives [s]", 1.0,
      [](auto& t) -> auto& { return t.controller.derivative_tau_s; });
  add(list, "max_roll_deg", 1.0, 60.0, "tilt in any direction [deg]", kDegPerRad,
      [](auto& t) -> auto& { return t.controller.max_tilt_rad; });
  add(list, "max_roll_rate_deg", 1.0, 2000.0, "roll and pitch rate [deg/s]", kDegPerRad,
      [](auto& t) -> auto& { return t.controller.max_roll_pitch_rate_rad_s; });
  add(list, "max_yaw_rate_deg", 1.0, 1000.0, "[deg/s]", kDegPerRad,
      [](auto& t) -> auto& { return t.controller.max_yaw_rate_rad_s; });
  add(list, "max_roll_torque", 0.001, 1000.0, "roll and pitch [N m]", 1.0,
      [](auto& t) -> auto& { return t.controller.max_roll_pitch_torque_Nm; });
  add(list, "max_yaw_torque", 0.001, 1000.0, "[N m]", 1.0,
      [](auto& t) -> auto& { return t.controller.max_yaw_torque_Nm; });
  add(list, "max_throttle", 0.1, 1.0, "of modes 5 to 7", 1.0,
      [](auto& t) -> auto& { return t.controller.max_throttle; });
  add(list, "min_throttle", 0.0, 0.9, "of modes 5 to 7", 1.0,
      [](auto& t) -> auto& { return t.controller.min_throttle; });
  add(list, "max_n_vel", 0.1, 50.0, "horizontal velocity that the position loops ask for [m/s]",
      1.0, [](auto& t) -> auto& { return t.controller.max_horizontal_velocity_m_s; });
  add(list, "max_descend_rate", 0.1, 20.0, "[m/s]", 1.0,
      [](auto& t) -> auto& { return t.controller.max_descend_m_s; });
  add(list, "max_climb_rate", 0.1, 20.0, "[m/s]", 1.0,
      [](auto& t) -> auto& { return t.controller.max_climb_m_s; });
  add(list, "max_descend_accel", 0.01, 0.95, "in units of gravity", 1.0 / kGravity_m_s2,
      [](auto& t) -> auto& { return t.controller.max_descend_acceleration_m_s2; });
}

void add_states(List& list) {
  add(list, "min_altitude_for_attitude_ctrl", 0.0, 2.0,
      "a take-off keeps level below this height over its own ground [m]", 1.0,
      [](auto& t) -> auto& { return t.states.lift_off_height_m; });
  add(list, "takeoff_d_pos", -100.0, -0.3, "of the take-off, from where it stands [m]", -1.0,
      [](auto& t) -> auto& { return t.states.takeoff_height_m; });
  add(list, "takeoff_d_vel", -20.0, -0.1, "of the take-off [m/s]", -1.0,
      [](auto& t) -> auto& { return t.states.takeoff_speed_m_s; });
  add(list, "takeoff_height_threshold", 0.01, 10.0, "take-off ends this far below its height [m]",
      1.0, [](auto& t) -> auto& { return t.states.takeoff_tolerance_m; });
  add(list, "takeoff_landing_pos_hold_time", 0.0, 600.0,
      "holds at least this long before commands are followed [s]", 1.0,
      [](auto& t) -> auto& { return t.states.hold_s; });
  add(list, "command_timeout_s", 0.01, 60.0, "an older command is not flown [s]", 1.0,
      [](auto& t) -> auto& { return t.states.command_timeout_s; });
  add(list, "lost_command_land_s", 0.1, 3600.0, "holds this long without commands, then lands [s]",
      1.0, [](auto& t) -> auto& { return t.states.lost_command_land_s; });
}

}  // namespace

List controller_parameters() {
  List list;
  add_loops(list);
  add_limits(list);
  add_states(list);
  return list;
}

}  // namespace rosflight::roscopter
