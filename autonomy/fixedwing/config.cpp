// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/config.hpp"

#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

using config::number_text;
using config::Range;
using config::Section;

void number(const Section& in, std::string_view key, double low, double high, double& value) {
  value = in.number(key, Range::between(low, high), value);
}

void degrees(const Section& in, std::string_view key, double low, double high, double& value_rad) {
  value_rad = in.number(key, Range::between(low, high), value_rad / kRadPerDeg) * kRadPerDeg;
}

/// kp, ki, kd of one loop; absent ones are 0 once the section is there.
void gains(const Section& in, std::string_view key, PidGains& value) {
  const auto section = in.optional_section(key);
  if (!section) return;
  const Range allowed = Range::between(0.0, 100.0);
  value = {section->number("kp", allowed), section->number("ki", allowed, 0.0),
           section->number("kd", allowed, 0.0)};
}

void read_limits(const Section& in, AutonomyConfig& out) {
  ControllerConfig& c = out.flight.controller;
  PlannerConfig& plan = out.flight.plan;
  MissionLimits& m = out.mission;
  number(in, "cruise_m_s", 3.0, 100.0, c.cruise_m_s);
  number(in, "min_airspeed_m_s", 2.0, c.cruise_m_s, c.min_airspeed_m_s);
  m.min_airspeed_m_s = 0.5 * (c.min_airspeed_m_s + c.cruise_m_s);
  number(in, "min_mission_airspeed_m_s", c.min_airspeed_m_s, c.cruise_m_s, m.min_airspeed_m_s);
  m.max_airspeed_m_s = 1.4 * c.cruise_m_s;
  number(in, "max_airspeed_m_s", c.cruise_m_s, 150.0, m.max_airspeed_m_s);
  degrees(in, "roll_deg", 10.0, 60.0, c.max_roll_rad);
  degrees(in, "roll_rate_deg_s", 10.0, 360.0, c.max_roll_rate_rad_s);
  degrees(in, "pitch_deg", 5.0, 45.0, c.max_pitch_rad);
  degrees(in, "nose_down_deg", -45.0, -5.0, c.min_pitch_rad);
  degrees(in, "alpha_deg", 3.0, 30.0, c.max_alpha_rad);
  degrees(in, "climb_deg", 1.0, 30.0, c.max_climb_rad);
  degrees(in, "descent_deg", 1.0, 30.0, c.max_descent_rad);
  number(in, "turn_radius_m", 5.0, 1000.0, plan.radius_m);
  degrees(in, "turn_bank_deg", 5.0, 60.0, m.max_bank_rad);
  plan.climb_slope = 0.6 * std::tan(c.max_climb_rad);
  plan.descent_slope = 0.6 * std::tan(c.max_descent_rad);
  number(in, "path_climb_slope", 0.01, std::tan(c.max_climb_rad), plan.climb_slope);
  number(in, "path_descent_slope", 0.01, std::tan(c.max_descent_rad), plan.descent_slope);
  number(in, "distance_m", 100.0, 100000.0, m.area.max_distance_m);
  number(in, "height_m", 10.0, 10000.0, m.area.max_height_m);
  number(in, "min_height_m", 1.0, 500.0, m.area.min_height_m);
  plan.airspeed_m_s = c.cruise_m_s;
  m.plan = plan;
  m.gravity_m_s2 = c.airframe.gravity_m_s2;
  const double bank = std::atan(c.cruise_m_s * c.cruise_m_s / (m.gravity_m_s2 * plan.radius_m));
  if (bank > m.max_bank_rad || m.max_bank_rad > c.max_roll_rad) {
    throw in.error("turn_radius_m",
                   number_text(plan.radius_m) + ", at cruise a bank of " +
                       number_text(std::round(bank / kRadPerDeg)) + " deg",
                   "at most turn_bank_deg, and that at most roll_deg");
  }
}

void read_follower(const Section& in, FlightConfig& out) {
  FollowerConfig& f = out.follower;
  degrees(in, "approach_deg", 5.0, 89.0, f.approach_rad);
  number(in, "line_gain_1_m", 1e-4, 1.0, f.line_gain_1_m);
  number(in, "circle_gain", 0.1, 20.0, f.circle_gain);
  number(in, "timeout_s", 0.05, 60.0, f.timeout_s);
  number(in, "lead_s", 0.0, 5.0, out.lead_s);
  f.max_roll_ff_rad = out.controller.max_roll_rad;
  f.gravity_m_s2 = out.controller.airframe.gravity_m_s2;
}

void read_energy(const Section& in, ControllerConfig& c) {
  c.longitudinal =
      in.choice<LongitudinalKind>("longitudinal",
                                  {{"total_energy", LongitudinalKind::kTotalEnergy},
                                   {"successive_loops", LongitudinalKind::kSuccessiveLoops}},
                                  c.longitudinal);
  gains(in, "energy", c.total_energy.energy);
  gains(in, "balance", c.total_energy.balance);
  gains(in, "height", c.successive_loops.height);
  gains(in, "airspeed", c.successive_loops.airspeed);
  number(in, "max_height_error_m", 1.0, 200.0, c.total_energy.max_height_error_m);
  c.successive_loops.max_height_error_m = c.total_energy.max_height_error_m;
  c.total_energy.gravity_m_s2 = c.airframe.gravity_m_s2;
  number(in, "throttle_cruise", 0.0, 1.0, c.throttle_cruise);
  number(in, "throttle_per_climb", 0.0, 20.0, c.throttle_per_climb);
  number(in, "throttle_per_speed_s_m", 0.0, 1.0, c.throttle_per_speed_s_m);
  number(in, "throttle_per_load", 0.0, 5.0, c.throttle_per_load);
  number(in, "min_throttle", 0.0, 0.9, c.min_throttle);
  number(in, "max_throttle", 0.1, 1.0, c.max_throttle);
  if (c.min_throttle >= c.max_throttle) {
    throw in.error("min_throttle", in.raw("min_throttle"), "less than max_throttle");
  }
}

void read_controller(const Section& in, ControllerConfig& c) {
  gains(in, "course", c.course);
  gains(in, "roll", c.roll);
  gains(in, "pitch", c.pitch);
  gains(in, "ground_course", c.ground_course);
  gains(in, "climb_rate", c.climb_rate);
  gains(in, "glide", c.glide);
  degrees(in, "glide_deg", -30.0, 0.0, c.glide_rad);
  number(in, "yaw_damper_s", 0.0, 10.0, c.yaw_damper_s);
  number(in, "yaw_washout_rad_s", 0.0, 50.0, c.yaw_washout_rad_s);
  degrees(in, "pitch_trim_deg", -10.0, 15.0, c.airframe.pitch_trim_rad);
  number(in, "speed_guard_rad_s_m", 0.0, 1.0, c.speed_guard_rad_s_m);
  number(in, "command_timeout_s", 0.05, 60.0, c.command_timeout_s);
  degrees(in, "lost_roll_deg", -45.0, 45.0, c.lost_roll_rad);
}

void read_takeoff(const Section& in, TakeoffConfig& t) {
  number(in, "height_m", 5.0, 500.0, t.height_m);
  number(in, "rotate_m_s", 0.0, 100.0, t.rotate_m_s);
  degrees(in, "pitch_deg", 0.0, 30.0, t.pitch_rad);
  number(in, "ramp_s", 0.05, 20.0, t.ramp_s);
  number(in, "airborne_m", 0.5, 50.0, t.airborne_m);
  number(in, "timeout_s", 1.0, 600.0, t.timeout_s);
  number(in, "margin_m", 0.5, 20.0, t.margin_m);
  if (t.airborne_m + t.margin_m >= t.height_m) {
    throw in.error("height_m", in.raw("height_m"), "more than airborne_m and margin_m together");
  }
}

void read_landing(const Section& in, LandingConfig& l, const PlannerConfig& plan) {
  number(in, "approach_height_m", 5.0, 300.0, l.approach_height_m);
  number(in, "glide_slope", 0.02, 0.5, l.glide_slope);
  l.level_m = std::max(l.level_m, 1.5 * plan.radius_m);
  number(in, "level_m", plan.radius_m, 5000.0, l.level_m);
  number(in, "airspeed_m_s", 2.0, 100.0, l.airspeed_m_s);
  number(in, "flare_time_s", 0.2, 10.0, l.flare_time_s);
  number(in, "touchdown_m_s", 0.05, 3.0, l.touchdown_m_s);
  number(in, "flare_throttle", 0.0, 1.0, l.flare_throttle);
  degrees(in, "roll_deg", 1.0, 45.0, l.max_roll_rad);
  degrees(in, "pitch_deg", 1.0, 30.0, l.max_pitch_rad);
  if (l.glide_slope > plan.descent_slope) {
    throw in.error("glide_slope", in.raw("glide_slope"),
                   "at most limits.path_descent_slope of " + number_text(plan.descent_slope));
  }
}

void read_safety(const Section& in, SafetyConfig& s) {
  number(in, "dead_reckoning_s", 0.0, 600.0, s.dead_reckoning_s);
  number(in, "return_height_m", 5.0, 1000.0, s.return_height_m);
  number(in, "motor_out_s", 0.5, 60.0, s.motor_out_s);
  number(in, "motor_out_m_s", 0.0, 10.0, s.motor_out_m_s);
  number(in, "glide_m_s", 2.0, 100.0, s.glide_m_s);
  number(in, "straight_below_m", 0.0, 200.0, s.straight_below_m);
  number(in, "longest_range_m", 0.0, 200.0, s.longest_range_m);
}

Airframe airframe_of(const VehicleFacts& vehicle, double elevator_travel_rad) {
  Airframe out;
  out.mass_kg = vehicle.mass_kg;
  out.gravity_m_s2 = vehicle.gravity_m_s2;
  out.wing_area_m2 = vehicle.wing_area_m2;
  out.density_kg_m3 = vehicle.density_kg_m3;
  out.lift_zero = vehicle.lift_zero;
  out.lift_slope_1_rad = vehicle.lift_alpha_1_rad;
  const double power = vehicle.pitch_elevator_1_rad * elevator_travel_rad;
  if (power < 0.0) {
    // C_m0 + C_ma alpha + C_mde de = 0, and a command by effect is the negative deflection.
    out.elevator_trim = vehicle.pitch_zero / power;
    out.elevator_1_rad = vehicle.pitch_alpha_1_rad / power;
  }
  return out;
}

}  // namespace

AutonomyConfig read_autonomy(const Section& autonomy, const VehicleFacts& vehicle) {
  AutonomyConfig out;
  double travel_rad = 0.0;
  degrees(autonomy, "elevator_travel_deg", 0.0, 90.0, travel_rad);
  out.flight.controller.airframe = airframe_of(vehicle, travel_rad);
  const config::Document nothing = config::Document::from_text("{}", "defaults");
  const auto section = [&](std::string_view key) {
    return autonomy.optional_section(key).value_or(nothing.root());
  };
  read_limits(section("limits"), out);
  read_energy(section("energy"), out.flight.controller);
  read_controller(section("controller"), out.flight.controller);
  read_follower(section("follower"), out.flight);
  read_takeoff(section("takeoff"), out.flight.takeoff);
  read_landing(section("landing"), out.flight.landing, out.flight.plan);
  read_safety(section("safety"), out.flight.safety);
  static_cast<void>(autonomy.foreign_section("estimator"));  // estimation/read_estimator.hpp
  autonomy.finish();
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
