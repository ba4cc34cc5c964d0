// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/config.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rosflight::autonomy {
namespace {

using config::Range;
using config::Section;

constexpr double kUsableThrust = 0.95;  // of full throttle: the rest is for attitude

double degrees(const Section& in, std::string_view key, Range allowed, double if_absent_rad) {
  return in.number(key, allowed, if_absent_rad / kRadPerDeg) * kRadPerDeg;
}

/// kp, ki, kd under names that carry their units; kp is needed, the others are 0 if absent.
struct GainNames {
  std::string_view kp, ki, kd;
};
constexpr GainNames kAccelerationFromPosition{"kp_1_s2", "ki_1_s3", "kd_1_s"};
constexpr GainNames kRateFromValue{"kp_1_s", "ki_1_s2", "kd"};
constexpr GainNames kTorqueFromAngle{"kp_Nm_rad", "ki_Nm_rad_s", "kd_Nms_rad"};
constexpr GainNames kTorqueFromRate{"kp_Nms_rad", "ki_Nm_rad", "kd_Nms2_rad"};

void read_gains(const Section& in, std::string_view key, const GainNames& names, PidGains& gains) {
  const auto section = in.optional_section(key);
  if (!section) return;
  const Range allowed = Range::between(0.0, 1000.0);
  gains = {section->number(names.kp, allowed), section->number(names.ki, allowed, 0.0),
           section->number(names.kd, allowed, 0.0)};
}

void read_limits(const Section& in, const VehicleFacts& vehicle, AutonomyConfig& out) {
  ControllerConfig& c = out.flight.controller;
  FollowerConfig& f = out.flight.follower;
  LegLimits& leg = out.flight.path.limits;
  MissionLimits& m = out.mission;
  const double weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  const double full_N = kUsableThrust * out.flight.thrust.max_thrust_N();
  c.max_tilt_rad = degrees(in, "tilt_deg", Range::between(1.0, 60.0), c.max_tilt_rad);
  c.max_roll_pitch_rate_rad_s = degrees(in, "roll_pitch_rate_deg_s", Range::between(1.0, 2000.0),
                                        c.max_roll_pitch_rate_rad_s);
  c.max_yaw_rate_rad_s =
      degrees(in, "yaw_rate_deg_s", Range::between(1.0, 1000.0), c.max_yaw_rate_rad_s);
  c.max_roll_pitch_torque_Nm =
      in.number("roll_pitch_torque_Nm", Range::positive(), c.max_roll_pitch_torque_Nm);
  c.max_yaw_torque_Nm = in.number("yaw_torque_Nm", Range::positive(), c.max_yaw_torque_Nm);
  c.min_thrust_N = weight_N * in.number("min_thrust_weights", Range::between(0.0, 0.9), 0.2);
  c.max_thrust_N =
      std::min(weight_N * in.number("max_thrust_weights", Range::between(1.1, 20.0), 2.0), full_N);
  f.min_lift_ratio = in.number("min_lift_weights", Range::between(0.05, 0.9), f.min_lift_ratio);
  leg.speed_m_s = in.number("speed_m_s", Range::between(0.1, 50.0), leg.speed_m_s);
  leg.acceleration_m_s2 =
      in.number("acceleration_m_s2", Range::between(0.1, 50.0), leg.acceleration_m_s2);
  leg.yaw_rate_rad_s =
      degrees(in, "leg_yaw_rate_deg_s", Range::between(1.0, 1000.0), leg.yaw_rate_rad_s);
  leg.yaw_acceleration_rad_s2 = degrees(in, "leg_yaw_acceleration_deg_s2",
                                        Range::between(1.0, 10000.0), leg.yaw_acceleration_rad_s2);
  c.max_climb_m_s = in.number("climb_m_s", Range::between(0.1, 20.0), c.max_climb_m_s);
  c.max_descend_m_s = in.number("descend_m_s", Range::between(0.1, 20.0), c.max_descend_m_s);
  c.max_descend_acceleration_m_s2 = in.number("descend_acceleration_m_s2", Range::between(0.1, 9.0),
                                              c.max_descend_acceleration_m_s2);
  m.max_distance_m = in.number("distance_m", Range::between(1.0, 100000.0), m.max_distance_m);
  m.max_height_m = in.number("height_m", Range::between(1.0, 10000.0), m.max_height_m);
  m.min_height_m = in.number("min_height_m", Range::between(-1000.0, 100.0), m.min_height_m);
  c.max_horizontal_velocity_m_s = m.max_speed_m_s = leg.speed_m_s;
  f.max_tilt_rad = c.max_tilt_rad;
  f.max_thrust_N = c.max_thrust_N;
  f.max_yaw_rate_rad_s = c.max_yaw_rate_rad_s;
}

void read_path(const Section& in, PathConfig& path) {
  path.interpolation = in.choice<Interpolation>(
      "interpolation", {{"quintic", Interpolation::kQuintic}, {"linear", Interpolation::kLinear}},
      path.interpolation);
  path.waypoint_tolerance_m =
      in.number("waypoint_tolerance_m", Range::between(0.01, 100.0), path.waypoint_tolerance_m);
  path.heading_tolerance_rad =
      degrees(in, "heading_tolerance_deg", Range::between(0.5, 180.0), path.heading_tolerance_rad);
  path.arrival_timeout_s =
      in.number("arrival_timeout_s", Range::between(0.1, 3600.0), path.arrival_timeout_s);
}

void read_follower(const Section& in, FollowerConfig& follower) {
  read_gains(in, "horizontal", kAccelerationFromPosition, follower.horizontal);
  read_gains(in, "vertical", kAccelerationFromPosition, follower.vertical);
  read_gains(in, "heading", kRateFromValue, follower.heading);
  follower.drag_1_s = in.number("drag_1_s", Range::between(0.0, 10.0), follower.drag_1_s);
  follower.attitude_lag_s =
      in.number("attitude_lag_s", Range::between(0.0, 2.0), follower.attitude_lag_s);
  follower.thrust_lag_s =
      in.number("thrust_lag_s", Range::between(0.0, 2.0), follower.thrust_lag_s);
  follower.max_position_error_m =
      in.number("max_position_error_m", Range::between(0.1, 100.0), follower.max_position_error_m);
  follower.timeout_s = in.number("timeout_s", Range::between(0.01, 60.0), follower.timeout_s);
}

void read_controller(const Section& in, ControllerConfig& c) {
  read_gains(in, "position_horizontal", kRateFromValue, c.position_horizontal);
  read_gains(in, "position_vertical", kRateFromValue, c.position_vertical);
  read_gains(in, "velocity_horizontal", kRateFromValue, c.velocity_horizontal);
  read_gains(in, "velocity_vertical", kRateFromValue, c.velocity_vertical);
  read_gains(in, "heading", kRateFromValue, c.heading_to_rate);
  read_gains(in, "roll_to_torque", kTorqueFromAngle, c.roll_to_torque);
  read_gains(in, "pitch_to_torque", kTorqueFromAngle, c.pitch_to_torque);
  read_gains(in, "yaw_to_torque", kTorqueFromAngle, c.yaw_to_torque);
  read_gains(in, "roll_rate_to_torque", kTorqueFromRate, c.roll_rate_to_torque);
  read_gains(in, "pitch_rate_to_torque", kTorqueFromRate, c.pitch_rate_to_torque);
  read_gains(in, "yaw_rate_to_torque", kTorqueFromRate, c.yaw_rate_to_torque);
  c.derivative_tau_s =
      in.number("derivative_tau_s", Range::between(0.001, 10.0), c.derivative_tau_s);
  c.min_throttle = in.number("min_throttle", Range::between(0.0, 0.9), c.min_throttle);
  c.max_throttle = in.number("max_throttle", Range::between(0.1, 1.0), c.max_throttle);
  if (c.min_throttle >= c.max_throttle) {
    throw in.error("min_throttle", in.raw("min_throttle"), "less than max_throttle");
  }
}

void read_takeoff(const Section& in, StateMachineConfig& states) {
  states.takeoff_height_m =
      in.number("height_m", Range::between(0.3, 100.0), states.takeoff_height_m);
  states.takeoff_speed_m_s =
      in.number("speed_m_s", Range::between(0.1, 20.0), states.takeoff_speed_m_s);
  states.takeoff_tolerance_m =
      in.number("tolerance_m", Range::between(0.01, 10.0), states.takeoff_tolerance_m);
  states.takeoff_timeout_s =
      in.number("timeout_s", Range::between(1.0, 600.0), states.takeoff_timeout_s);
  states.lift_off_height_m =
      in.number("lift_off_height_m", Range::between(0.0, 2.0), states.lift_off_height_m);
  if (states.takeoff_tolerance_m >= states.takeoff_height_m) {
    throw in.error("tolerance_m", in.raw("tolerance_m"), "less than height_m");
  }
}

void read_hold(const Section& in, StateMachineConfig& states) {
  states.hold_s = in.number("time_s", Range::between(0.0, 600.0), states.hold_s);
  states.settle_distance_m =
      in.number("settle_distance_m", Range::between(0.01, 100.0), states.settle_distance_m);
  states.settle_speed_m_s =
      in.number("settle_speed_m_s", Range::between(0.01, 10.0), states.settle_speed_m_s);
  states.settle_timeout_s =
      in.number("settle_timeout_s", Range::between(0.0, 600.0), states.settle_timeout_s);
  states.command_timeout_s =
      in.number("command_timeout_s", Range::between(0.01, 60.0), states.command_timeout_s);
  states.lost_command_land_s =
      in.number("lost_command_land_s", Range::between(0.1, 3600.0), states.lost_command_land_s);
}

void read_landing(const Section& in, LandingConfig& landing) {
  landing.speed_m_s = in.number("speed_m_s", Range::between(0.1, 20.0), landing.speed_m_s);
  landing.touchdown_speed_m_s =
      in.number("touchdown_speed_m_s", Range::between(0.1, 2.0), landing.touchdown_speed_m_s);
  landing.slow_height_m =
      in.number("slow_height_m", Range::between(0.1, 100.0), landing.slow_height_m);
  landing.acceleration_m_s2 =
      in.number("acceleration_m_s2", Range::between(0.1, 10.0), landing.acceleration_m_s2);
  landing.contact_s = in.number("contact_s", Range::between(0.1, 10.0), landing.contact_s);
  landing.unload_s = in.number("unload_s", Range::between(0.2, 10.0), landing.unload_s);
  if (landing.touchdown_speed_m_s > landing.speed_m_s) {
    throw in.error("touchdown_speed_m_s", in.raw("touchdown_speed_m_s"), "at most speed_m_s");
  }
}

ThrustModel read_thrust(const Section& in, const VehicleFacts& vehicle) {
  ThrustModel::Curve curve;
  if (const auto measured = in.optional_section("thrust_curve")) {
    curve = {measured->number("max_thrust_N", Range::positive()),
             measured->number("constant", Range::between(0.0, 0.9)),
             measured->number("root", Range::between(0.0, 1.0)),
             measured->number("nominal_voltage_V", Range::positive())};
  } else {
    curve = ThrustModel::curve_of(vehicle.rotors);
  }
  try {
    return ThrustModel(curve, vehicle.throttle);
  } catch (const std::invalid_argument& fault) {
    throw in.error("a vehicle without a usable thrust curve", fault.what());
  }
}

}  // namespace

AutonomyConfig read_autonomy(const Section& autonomy, const VehicleFacts& vehicle) {
  AutonomyConfig out;
  out.flight.thrust = read_thrust(autonomy, vehicle);
  out.flight.controller.mass_kg = out.flight.follower.mass_kg = vehicle.mass_kg;
  out.flight.controller.gravity_m_s2 = out.flight.follower.gravity_m_s2 = vehicle.gravity_m_s2;
  const double weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  const double full_N = out.flight.thrust.max_thrust_N();
  if (full_N * kUsableThrust < 1.1 * weight_N) {
    throw autonomy.error("full throttle of " + config::number_text(full_N) + " N for a weight of " +
                             config::number_text(weight_N) + " N",
                         "a thrust of 1.16 weights and more");
  }
  auto& controller = out.flight.controller;
  controller.attitude_loops = autonomy.choice<AttitudeLoops>(
      "attitude_loops",
      {{"firmware", AttitudeLoops::kFirmware}, {"autonomy", AttitudeLoops::kAutonomy}},
      AttitudeLoops::kFirmware);
  if (controller.attitude_loops == AttitudeLoops::kAutonomy &&
      !(vehicle.throttle.firmware_max_thrust_N > 0.0)) {
    throw autonomy.error("attitude_loops", "autonomy",
                         "firmware, because the mixer takes newtons only with USE_MOTOR_PARAM = 1");
  }
  // An absent section is an empty one, so that all defaults are taken in one place.
  const config::Document nothing = config::Document::from_text("{}", "defaults");
  const auto section = [&](std::string_view key) {
    return autonomy.optional_section(key).value_or(nothing.root());
  };
  read_limits(section("limits"), vehicle, out);
  read_path(section("path"), out.flight.path);
  read_follower(section("follower"), out.flight.follower);
  read_controller(section("controller"), out.flight.controller);
  read_takeoff(section("takeoff"), out.flight.states);
  read_hold(section("hold"), out.flight.states);
  read_landing(section("landing"), out.flight.states.landing);
  static_cast<void>(autonomy.foreign_section("estimator"));  // estimation/read_estimator.hpp
  autonomy.finish();
  return out;
}

}  // namespace rosflight::autonomy
