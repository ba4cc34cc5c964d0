// SPDX-License-Identifier: BSD-3-Clause
#include "roscopter/controller_parameters.hpp"

#include "base/constants.hpp"

namespace roscopter {

namespace base = rosflight::base;
namespace config = rosflight::config;
namespace {

using autonomy::PidGains;
using autonomy::multirotor::ControllerConfig;
using autonomy::multirotor::StateMachineConfig;
using config::kDeg;
using config::kDegPerS;
using config::Range;
using config::Table;
using rosflight_common::gains_row;

constexpr config::Unit kGravities{"gravity", base::kStandardGravity_m_s2};

Table<ControllerConfig> loops() {
  using C = ControllerConfig;
  const auto loop = [](const char* prefix, auto member, const char* text, config::Unit unit = "") {
    return gains_row<C>(prefix, member, unit, Range::between(-1000.0, 1000.0), text);
  };
  const auto east = [](std::optional<PidGains> C::*gains) {
    return [gains](C& c) -> PidGains& { return *(c.*gains); };  // the node has given it a value
  };
  const char* torque = "from an angle [rad] to a torque [N m]";
  const char* rate = "from a rate [rad/s] to a torque [N m]";
  const char* speed = "from a velocity [m/s] to an acceleration";
  const char* place = "from a position [m] to a velocity [m/s]";
  return {loop("roll_to_torque", &C::roll_to_torque, torque),
          loop("pitch_to_torque", &C::pitch_to_torque, torque),
          loop("yaw_to_torque", &C::yaw_to_torque, torque),
          loop("roll_rate_to_torque", &C::roll_rate_to_torque, rate),
          loop("pitch_rate_to_torque", &C::pitch_rate_to_torque, rate),
          loop("yaw_rate_to_torque", &C::yaw_rate_to_torque, rate),
          loop("yaw_to_rate", &C::heading_to_rate, "from the heading [rad] to a yaw rate [rad/s]"),
          loop("vel_n_to_accel", &C::velocity_horizontal, speed, kGravities),
          loop("vel_e_to_accel", east(&C::velocity_east), speed, kGravities),
          loop("vel_d_to_accel", &C::velocity_vertical, speed, kGravities),
          loop("pos_n_to_vel", &C::position_horizontal, place),
          loop("pos_e_to_vel", east(&C::position_east), place),
          loop("pos_d_to_vel", &C::position_vertical, place)};
}

Table<ControllerConfig> limits() {
  using C = ControllerConfig;
  return {
      {"mass", &C::mass_kg, "kg", Range::between(0.01, 1000.0), ""},
      {"gravity", &C::gravity_m_s2, "m/s^2", Range::between(9.0, 10.0), ""},
      {"tau", &C::derivative_tau_s, "s", Range::between(0.001, 10.0), "of derivatives"},
      {"max_roll_deg", &C::max_tilt_rad, kDeg, Range::between(1.0, 60.0), "tilt in any direction"},
      {"max_roll_rate_deg", &C::max_roll_pitch_rate_rad_s, kDegPerS, Range::between(1.0, 2000.0),
       "roll and pitch rate"},
      {"max_yaw_rate_deg", &C::max_yaw_rate_rad_s, kDegPerS, Range::between(1.0, 1000.0), ""},
      {"max_roll_torque", &C::max_roll_pitch_torque_Nm, "N m", Range::between(0.001, 1000.0),
       "roll and pitch"},
      {"max_yaw_torque", &C::max_yaw_torque_Nm, "N m", Range::between(0.001, 1000.0), ""},
      {"max_throttle", &C::max_throttle, "", Range::between(0.1, 1.0), "of modes 5 to 7"},
      {"min_throttle", &C::min_throttle, "", Range::between(0.0, 0.9), "of modes 5 to 7"},
      {"max_n_vel", &C::max_horizontal_velocity_m_s, "m/s", Range::between(0.1, 50.0),
       "horizontal velocity that the position loops ask for"},
      {"max_descend_rate", &C::max_descend_m_s, "m/s", Range::between(0.1, 20.0), ""},
      {"max_climb_rate", &C::max_climb_m_s, "m/s", Range::between(0.1, 20.0), ""},
      {"max_descend_accel", &C::max_descend_acceleration_m_s2, kGravities,
       Range::between(0.01, 0.95), ""}};
}

Table<StateMachineConfig> states() {
  using S = StateMachineConfig;
  constexpr config::Unit kUp{"m", -1.0};  // the parameter counts downwards
  constexpr config::Unit kClimb{"m/s", -1.0};
  return {{"min_altitude_for_attitude_ctrl", &S::lift_off_height_m, "m", Range::between(0.0, 2.0),
           "a take-off keeps level below this height over its own ground"},
          {"takeoff_d_pos", &S::takeoff_height_m, kUp, Range::between(-100.0, -0.3),
           "of the take-off, from where it stands"},
          {"takeoff_d_vel", &S::takeoff_speed_m_s, kClimb, Range::between(-20.0, -0.1),
           "of the take-off"},
          {"takeoff_height_threshold", &S::takeoff_tolerance_m, "m", Range::between(0.01, 10.0),
           "take-off ends this far below its height"},
          {"takeoff_landing_pos_hold_time", &S::hold_s, "s", Range::between(0.0, 600.0),
           "holds at least this long before commands are followed"},
          {"command_timeout_s", &S::command_timeout_s, "s", Range::between(0.01, 60.0),
           "an older command is not flown"},
          {"lost_command_land_s", &S::lost_command_land_s, "s", Range::between(0.1, 3600.0),
           "holds this long without commands, then lands"}};
}

}  // namespace

Table<Tuning> controller_parameters() {
  return {{"", &Tuning::controller, loops()},
          {"", &Tuning::controller, limits()},
          {"", &Tuning::states, states()}};
}

}  // namespace roscopter
