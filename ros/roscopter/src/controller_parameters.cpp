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
  const char* torque = "gain from an angle [rad] to a torque [N m]";
  const char* rate = "gain from a rate [rad/s] to a torque [N m]";
  const char* speed = "gain from a velocity [m/s] to an acceleration";
  const char* position = "gain from a position [m] to a velocity [m/s]";
  return {
      loop("roll_to_torque", &C::roll_to_torque, torque),
      loop("pitch_to_torque", &C::pitch_to_torque, torque),
      loop("yaw_to_torque", &C::yaw_to_torque, torque),
      loop("roll_rate_to_torque", &C::roll_rate_to_torque, rate),
      loop("pitch_rate_to_torque", &C::pitch_rate_to_torque, rate),
      loop("yaw_rate_to_torque", &C::yaw_rate_to_torque, rate),
      loop("yaw_to_rate", &C::heading_to_rate, "gain from the heading [rad] to a yaw rate [rad/s]"),
      loop("vel_n_to_accel", &C::velocity_horizontal, speed, kGravities),
      loop("vel_e_to_accel", east(&C::velocity_east), speed, kGravities),
      loop("vel_d_to_accel", &C::velocity_vertical, speed, kGravities),
      loop("pos_n_to_vel", &C::position_horizontal, position),
      loop("pos_e_to_vel", east(&C::position_east), position),
      loop("pos_d_to_vel", &C::position_vertical, position)};
}

Table<ControllerConfig> limits() {
  using C = ControllerConfig;
  return {
      {"mass", &C::mass_kg, "kg", Range::between(0.01, 1000.0), "mass of the vehicle"},
      {"gravity", &C::gravity_m_s2, "m/s^2", Range::between(9.0, 10.0), "gravity"},
      {"tau", &C::derivative_tau_s, "s", Range::between(0.001, 10.0),
       "time constant of derivatives"},
      {"max_roll_deg", &C::max_tilt_rad, kDeg, Range::between(1.0, 60.0),
       "maximum tilt in any direction"},
      {"max_roll_rate_deg", &C::max_roll_pitch_rate_rad_s, kDegPerS, Range::between(1.0, 2000.0),
       "maximum roll and pitch rate"},
      {"max_yaw_rate_deg", &C::max_yaw_rate_rad_s, kDegPerS, Range::between(1.0, 1000.0),
       "maximum yaw rate"},
      {"max_roll_torque", &C::max_roll_pitch_torque_Nm, "N m", Range::between(0.001, 1000.0),
       "maximum roll and pitch torque"},
      {"max_yaw_torque", &C::max_yaw_torque_Nm, "N m", Range::between(0.001, 1000.0),
       "maximum yaw torque"},
      {"max_throttle", &C::max_throttle, "", Range::between(0.1, 1.0),
       "maximum throttle of modes 5 to 7"},
      {"min_throttle", &C::min_throttle, "", Range::between(0.0, 0.9),
       "minimum throttle of modes 5 to 7"},
      {"max_n_vel", &C::max_horizontal_velocity_m_s, "m/s", Range::between(0.1, 50.0),
       "maximum horizontal velocity of the position loops"},
      {"max_descend_rate", &C::max_descend_m_s, "m/s", Range::between(0.1, 20.0),
       "maximum descent rate"},
      {"max_climb_rate", &C::max_climb_m_s, "m/s", Range::between(0.1, 20.0), "maximum climb rate"},
      {"max_descend_accel", &C::max_descend_acceleration_m_s2, kGravities,
       Range::between(0.01, 0.95), "maximum downward acceleration"}};
}

Table<StateMachineConfig> states() {
  using S = StateMachineConfig;
  constexpr config::Unit kUp{"m", -1.0};  // the parameter counts downwards
  constexpr config::Unit kClimb{"m/s", -1.0};
  return {{"min_altitude_for_attitude_ctrl", &S::lift_off_height_m, "m", Range::between(0.0, 2.0),
           "height above its own ground below which a take-off keeps level"},
          {"takeoff_d_pos", &S::takeoff_height_m, kUp, Range::between(-100.0, -0.3),
           "down position of the take-off, from where it stands"},
          {"takeoff_d_vel", &S::takeoff_speed_m_s, kClimb, Range::between(-20.0, -0.1),
           "down velocity of the take-off"},
          {"takeoff_height_threshold", &S::takeoff_tolerance_m, "m", Range::between(0.01, 10.0),
           "distance below its height at which a take-off ends"},
          {"takeoff_landing_pos_hold_time", &S::hold_s, "s", Range::between(0.0, 600.0),
           "minimum time of holding before commands are followed"},
          {"command_timeout_s", &S::command_timeout_s, "s", Range::between(0.01, 60.0),
           "maximum age of a command that is followed"},
          {"lost_command_land_s", &S::lost_command_land_s, "s", Range::between(0.1, 3600.0),
           "time of holding without commands before it lands"}};
}

}  // namespace

Table<Tuning> controller_parameters() {
  return {{"", &Tuning::controller, loops()},
          {"", &Tuning::controller, limits()},
          {"", &Tuning::states, states()}};
}

}  // namespace roscopter
