// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/config.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "config/table.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

using config::at;
using config::kDeg;
using config::kDegPerS;
using config::kDegPerS2;
using config::Range;
using config::Row;
using config::Section;
using config::Table;

constexpr double kUsableThrust = 0.95;  // of full throttle: the rest is for attitude

/// kp, ki, kd under names that carry their units; kp is needed, the others are 0 if absent.
Table<PidGains> gains(std::string_view kp, std::string_view ki, std::string_view kd) {
  const Range allowed = Range::between(0.0, 1000.0);
  return Table<PidGains>{Row<PidGains>{kp, &PidGains::kp, "", allowed, "proportional"}.needed(),
                         {ki, &PidGains::ki, "", allowed, "integral"},
                         {kd, &PidGains::kd, "", allowed, "derivative"}}
      .whole();
}
Table<PidGains> acceleration_gains() {
  return gains("kp_1_s2", "ki_1_s3", "kd_1_s");
}
Table<PidGains> rate_gains() {
  return gains("kp_1_s", "ki_1_s2", "kd");
}
Table<PidGains> angle_gains() {
  return gains("kp_Nm_rad", "ki_Nm_rad_s", "kd_Nms_rad");
}
Table<PidGains> angular_rate_gains() {
  return gains("kp_Nms_rad", "ki_Nm_rad", "kd_Nms2_rad");
}

Table<ThrustModel::Curve> curve_table() {
  using C = ThrustModel::Curve;
  using R = Row<C>;
  return {R{"max_thrust_N", &C::max_thrust_N, "N", Range::positive(), "at motor output 1"}.needed(),
          R{"constant", &C::constant, "", Range::between(0.0, 0.9), "share of the output"}.needed(),
          R{"root", &C::root, "", Range::between(0.0, 1.0), "share of the output"}.needed(),
          R{"nominal_voltage_V", &C::nominal_voltage_V, "V", Range::positive(), ""}.needed()};
}

Table<ControllerConfig> controller_limits() {
  using C = ControllerConfig;
  return {
      {"tilt_deg", &C::max_tilt_rad, kDeg, Range::between(1.0, 60.0),
       "of every commanded attitude"},
      {"roll_pitch_rate_deg_s", &C::max_roll_pitch_rate_rad_s, kDegPerS,
       Range::between(1.0, 2000.0), "commanded roll and pitch rate"},
      {"yaw_rate_deg_s", &C::max_yaw_rate_rad_s, kDegPerS, Range::between(1.0, 1000.0),
       "commanded yaw rate"},
      {"roll_pitch_torque_Nm", &C::max_roll_pitch_torque_Nm, "N m", Range::positive(),
       "commanded roll and pitch torque"},
      {"yaw_torque_Nm", &C::max_yaw_torque_Nm, "N m", Range::positive(), "commanded yaw torque"},
      {"climb_m_s", &C::max_climb_m_s, "m/s", Range::between(0.1, 20.0),
       "climb rate commanded by the position loops"},
      {"descend_m_s", &C::max_descend_m_s, "m/s", Range::between(0.1, 20.0),
       "descent rate commanded by the position loops"},
      {"descend_acceleration_m_s2", &C::max_descend_acceleration_m_s2, "m/s^2",
       Range::between(0.1, 9.0), "downward acceleration commanded by the velocity loops"}};
}

Table<LegLimits> leg_limits() {
  using L = LegLimits;
  return {{"speed_m_s", &L::speed_m_s, "m/s", Range::between(0.1, 50.0),
           "maximum speed of legs; also limits position loops and missions"},
          {"acceleration_m_s2", &L::acceleration_m_s2, "m/s^2", Range::between(0.1, 50.0),
           "maximum acceleration of legs"},
          {"leg_yaw_rate_deg_s", &L::yaw_rate_rad_s, kDegPerS, Range::between(1.0, 1000.0),
           "turning along legs"},
          {"leg_yaw_acceleration_deg_s2", &L::yaw_acceleration_rad_s2, kDegPerS2,
           Range::between(1.0, 10000.0), "turning along legs"}};
}

Table<MissionLimits> mission_limits() {
  using M = MissionLimits;
  return {{"distance_m", &M::max_distance_m, "m", Range::between(1.0, 100000.0),
           "horizontal distance of a mission from the start"},
          {"height_m", &M::max_height_m, "m", Range::between(1.0, 10000.0),
           "of a mission above the start"},
          {"min_height_m", &M::min_height_m, "m", Range::between(-1000.0, 100.0),
           "of a mission above the start"}};
}

Table<AutonomyConfig> thrust_limits() {
  using A = AutonomyConfig;
  return {{"min_thrust_weights", &A::min_thrust_weights, "weights", Range::between(0.0, 0.9),
           "in weights of the vehicle"},
          {"max_thrust_weights", &A::max_thrust_weights, "weights", Range::between(1.1, 20.0),
           "in weights of the vehicle; at most 95 % of full throttle"},
          {"min_lift_weights",
           at(&A::flight, &FlightConfig::follower, &FollowerConfig::min_lift_ratio), "weights",
           Range::between(0.05, 0.9), "smallest upward thrust while following a trajectory"}};
}

Table<PathConfig> path_table() {
  using P = PathConfig;
  return {{"interpolation",
           &P::interpolation,
           {{"quintic", Interpolation::kQuintic}, {"linear", Interpolation::kLinear}},
           "quintic: rest to rest; linear: straight, passing waypoints at their speed"},
          {"waypoint_tolerance_m", &P::waypoint_tolerance_m, "m", Range::between(0.01, 100.0),
           "within both tolerances a waypoint is reached"},
          {"heading_tolerance_deg", &P::heading_tolerance_rad, kDeg, Range::between(0.5, 180.0),
           "within both tolerances a waypoint is reached"},
          {"arrival_timeout_s", &P::arrival_timeout_s, "s", Range::between(0.1, 3600.0),
           "wait for the vehicle at the end of a leg; then the waypoint counts as missed"}};
}

Table<FollowerConfig> follower_table() {
  using F = FollowerConfig;
  return {
      {"horizontal", &F::horizontal, acceleration_gains(), "metres to metres per second squared"},
      {"vertical", &F::vertical, acceleration_gains(), "metres to metres per second squared"},
      {"heading", &F::heading, rate_gains(), "radians to radians per second"},
      {"drag_1_s", &F::drag_1_s, "1/s", Range::between(0.0, 10.0),
       "deceleration per speed, fed forward; of rotors: drag per thrust times gravity"},
      {"attitude_lag_s", &F::attitude_lag_s, "s", Range::between(0.0, 2.0),
       "delay of roll and pitch, compensated with the jerk of the leg"},
      {"thrust_lag_s", &F::thrust_lag_s, "s", Range::between(0.0, 2.0),
       "delay of the thrust, compensated with the jerk of the leg"},
      {"max_position_error_m", &F::max_position_error_m, "m", Range::between(0.1, 100.0),
       "a larger error counts as this"},
      {"timeout_s", &F::timeout_s, "s", Range::between(0.01, 60.0),
       "age up to which a setpoint is followed"}};
}

Table<ControllerConfig> controller_table() {
  using C = ControllerConfig;
  return {
      {"position_horizontal", &C::position_horizontal, rate_gains(), "metres to metres per second"},
      {"position_vertical", &C::position_vertical, rate_gains(), "metres to metres per second"},
      {"velocity_horizontal", &C::velocity_horizontal, rate_gains(),
       "metres per second to metres per second squared"},
      {"velocity_vertical", &C::velocity_vertical, rate_gains(),
       "metres per second to metres per second squared"},
      {"heading", &C::heading_to_rate, rate_gains(), "radians to radians per second"},
      {"roll_to_torque", &C::roll_to_torque, angle_gains(), "radians to newton metres"},
      {"pitch_to_torque", &C::pitch_to_torque, angle_gains(), "radians to newton metres"},
      {"yaw_to_torque", &C::yaw_to_torque, angle_gains(), "radians to newton metres"},
      {"roll_rate_to_torque", &C::roll_rate_to_torque, angular_rate_gains(),
       "radians per second to newton metres"},
      {"pitch_rate_to_torque", &C::pitch_rate_to_torque, angular_rate_gains(),
       "radians per second to newton metres"},
      {"yaw_rate_to_torque", &C::yaw_rate_to_torque, angular_rate_gains(),
       "radians per second to newton metres"},
      {"derivative_tau_s", &C::derivative_tau_s, "s", Range::between(0.001, 10.0),
       "filter of derivatives that are not measured"},
      Row<C>{"min_throttle", &C::min_throttle, "", Range::between(0.0, 0.9),
             "of the throttle modes"}
          .must("less than max_throttle",
                [](const C& c) { return c.min_throttle < c.max_throttle; }),
      {"max_throttle", &C::max_throttle, "", Range::between(0.1, 1.0), "of the throttle modes"}};
}

Table<StateMachineConfig> takeoff_table() {
  using S = StateMachineConfig;
  return {{"height_m", &S::takeoff_height_m, "m", Range::between(0.3, 100.0),
           "above where the vehicle stands"},
          {"speed_m_s", &S::takeoff_speed_m_s, "m/s", Range::between(0.1, 20.0), "of the climb"},
          Row<S>{"tolerance_m", &S::takeoff_tolerance_m, "m", Range::between(0.01, 10.0),
                 "take-off ends this far below its height"}
              .must("less than height_m",
                    [](const S& s) { return s.takeoff_tolerance_m < s.takeoff_height_m; }),
          {"timeout_s", &S::takeoff_timeout_s, "s", Range::between(1.0, 600.0),
           "then take-off is given up"},
          {"lift_off_height_m", &S::lift_off_height_m, "m", Range::between(0.0, 2.0),
           "below this height over the ground a take-off keeps level"}};
}

Table<StateMachineConfig> hold_table() {
  using S = StateMachineConfig;
  return {{"time_s", &S::hold_s, "s", Range::between(0.0, 600.0),
           "stays at least this long before commands are followed"},
          {"settle_distance_m", &S::settle_distance_m, "m", Range::between(0.01, 100.0),
           "stays until it is this close to the hold point"},
          {"settle_speed_m_s", &S::settle_speed_m_s, "m/s", Range::between(0.01, 10.0),
           "and this slow"},
          {"settle_timeout_s", &S::settle_timeout_s, "s", Range::between(0.0, 600.0),
           "but at most this much longer than time_s"},
          {"command_timeout_s", &S::command_timeout_s, "s", Range::between(0.01, 60.0),
           "age up to which a command is followed"},
          {"lost_command_land_s", &S::lost_command_land_s, "s", Range::between(0.1, 3600.0),
           "holds this long without a valid command, then lands"}};
}

Table<LandingConfig> landing_table() {
  using L = LandingConfig;
  return {
      {"speed_m_s", &L::speed_m_s, "m/s", Range::between(0.1, 20.0), "of the descent"},
      Row<L>{"touchdown_speed_m_s", &L::touchdown_speed_m_s, "m/s", Range::between(0.1, 2.0),
             "at the height of the start"}
          .must("at most speed_m_s",
                [](const L& l) { return l.touchdown_speed_m_s <= l.speed_m_s; }),
      {"slow_height_m", &L::slow_height_m, "m", Range::between(0.1, 100.0),
       "slows down from here to the height of the start"},
      {"acceleration_m_s2", &L::acceleration_m_s2, "m/s^2", Range::between(0.1, 10.0),
       "as the descent begins"},
      {"contact_s", &L::contact_s, "s", Range::between(0.1, 10.0),
       "slower than commanded for this long: contact with the ground"},
      {"unload_s", &L::unload_s, "s", Range::between(0.2, 10.0), "ramp from hover thrust to none"}};
}

/// Limits that several parts share.
void share_limits(const VehicleFacts& vehicle, AutonomyConfig& out) {
  ControllerConfig& c = out.flight.controller;
  FollowerConfig& f = out.flight.follower;
  const double weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  const double full_N = kUsableThrust * out.flight.thrust.max_thrust_N();
  c.min_thrust_N = weight_N * out.min_thrust_weights;
  c.max_thrust_N = std::min(weight_N * out.max_thrust_weights, full_N);
  c.max_horizontal_velocity_m_s = out.mission.max_speed_m_s = out.flight.path.limits.speed_m_s;
  f.max_tilt_rad = c.max_tilt_rad;
  f.max_thrust_N = c.max_thrust_N;
  f.max_yaw_rate_rad_s = c.max_yaw_rate_rad_s;
}

double thrust_gain_N_s2(const RotorData& rotors) {
  const double d2 = rotors.diameter_m * rotors.diameter_m;
  return rotors.thrust_coefficient * rotors.air_density_kg_m3 * d2 * d2 / (4.0 * kPi * kPi);
}

ThrustModel thrust_model(const Section& in, const AutonomyConfig& config,
                         const VehicleFacts& vehicle) {
  try {
    return ThrustModel(
        config.thrust_curve ? *config.thrust_curve : ThrustModel::curve_of(vehicle.rotors),
        vehicle.throttle);
  } catch (const std::invalid_argument& fault) {
    throw in.error("a vehicle without a usable thrust curve", fault.what());
  }
}

}  // namespace

Table<AutonomyConfig> parameters() {
  using A = AutonomyConfig;
  using F = FlightConfig;
  return {
      {"attitude_loops",
       at(&A::flight, &F::controller, &ControllerConfig::attitude_loops),
       {{"firmware", AttitudeLoops::kFirmware}, {"autonomy", AttitudeLoops::kAutonomy}},
       "firmware: angles and a throttle go out; autonomy: force and torques, needs "
       "USE_MOTOR_PARAM = 1"},
      {"thrust_curve", &A::thrust_curve, curve_table(),
       "measured; else it follows from the rotors: autonomy/multirotor/thrust_model.hpp"},
      {"limits", at(&A::flight, &F::controller), controller_limits()},
      {"limits", [](A& a) -> A& { return a; }, thrust_limits()},
      {"limits", at(&A::flight, &F::path, &PathConfig::limits), leg_limits()},
      {"limits", &A::mission, mission_limits()},
      {"path", at(&A::flight, &F::path), path_table()},
      {"follower", at(&A::flight, &F::follower), follower_table(), "Flies trajectories."},
      {"controller", at(&A::flight, &F::controller), controller_table(),
       "Take-off, hold, landing, and commands from outside."},
      {"takeoff", at(&A::flight, &F::states), takeoff_table()},
      {"hold", at(&A::flight, &F::states), hold_table()},
      {"landing", at(&A::flight, &F::states, &StateMachineConfig::landing), landing_table()},
      {"safety", at(&A::flight),
       config::Table<F>{{"return_height_m", &F::return_height_m, "m", Range::between(0.5, 1000.0),
                         "of a return, above the start, at least"}}},
      {"battery", at(&A::flight, &F::battery), battery_table(),
       "Cells, capacity and resistance come from the section `battery`."}};
}

AutonomyConfig read_autonomy(const Section& autonomy, const VehicleFacts& vehicle) {
  AutonomyConfig out;
  static const Table<AutonomyConfig> table = parameters();
  table.read(autonomy, out);
  out.flight.battery.cells = vehicle.battery.cells;
  out.flight.battery.capacity_Ah = vehicle.battery.capacity_Ah;
  out.flight.battery.resistance_ohm = vehicle.battery.resistance_ohm;
  out.flight.thrust = thrust_model(autonomy, out, vehicle);
  out.flight.rotor_watch = vehicle.rotor_watch;
  out.flight.rotor_watch.curve =
      out.thrust_curve ? *out.thrust_curve : ThrustModel::curve_of(vehicle.rotors);
  out.flight.rotor_watch.drag_per_thrust_m = vehicle.rotors.torque_coefficient *
                                             vehicle.rotors.diameter_m /
                                             vehicle.rotors.thrust_coefficient;
  out.flight.rotor_watch.thrust_gain_N_s2 = thrust_gain_N_s2(vehicle.rotors);
  out.flight.rotor_watch.rotor_drag_s_m = out.flight.follower.drag_1_s / vehicle.gravity_m_s2;
  out.flight.rotor_watch.weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  out.flight.controller.mass_kg = out.flight.follower.mass_kg = vehicle.mass_kg;
  out.flight.controller.gravity_m_s2 = out.flight.follower.gravity_m_s2 = vehicle.gravity_m_s2;
  const double weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  const double full_N = out.flight.thrust.max_thrust_N();
  if (full_N * kUsableThrust < 1.1 * weight_N) {
    throw autonomy.error("full throttle of " + config::number_text(full_N) + " N for a weight of " +
                             config::number_text(weight_N) + " N",
                         "a thrust of 1.16 weights and more");
  }
  if (out.flight.controller.attitude_loops == AttitudeLoops::kAutonomy &&
      !(vehicle.throttle.firmware_max_thrust_N > 0.0)) {
    throw autonomy.error("attitude_loops", "autonomy",
                         "firmware, because the mixer takes newtons only with USE_MOTOR_PARAM = 1");
  }
  share_limits(vehicle, out);
  static_cast<void>(autonomy.foreign_section("estimator"));  // estimation/read_estimator.hpp
  autonomy.finish();
  return out;
}

}  // namespace rosflight::autonomy::multirotor
