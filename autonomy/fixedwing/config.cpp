// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/config.hpp"

#include <algorithm>
#include <cmath>

#include "config/table.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

using config::at;
using config::kDeg;
using config::kDegPerS;
using config::number_text;
using config::Range;
using config::Row;
using config::Section;
using config::Table;

/// kp, ki, kd of one loop; absent ones are 0 once the section is there.
Table<PidGains> gains() {
  const Range allowed = Range::between(0.0, 100.0);
  return Table<PidGains>{Row<PidGains>{"kp", &PidGains::kp, "", allowed, "proportional"}.needed(),
                         {"ki", &PidGains::ki, "", allowed, "integral"},
                         {"kd", &PidGains::kd, "", allowed, "derivative"}}
      .whole();
}

/// A member of a part of the configuration.
template <class T>
auto in_controller(T ControllerConfig::*member) {
  return at(&AutonomyConfig::flight, &FlightConfig::controller, member);
}
template <class T>
auto in_plan(T PlannerConfig::*member) {
  return at(&AutonomyConfig::flight, &FlightConfig::plan, member);
}
template <class T>
auto in_mission(T MissionLimits::*member) {
  return at(&AutonomyConfig::mission, member);
}

Table<AutonomyConfig> speed_limits() {
  using A = AutonomyConfig;
  using C = ControllerConfig;
  using R = Row<A>;
  return {
      R{"cruise_m_s", in_controller(&C::cruise_m_s), "m/s", Range::between(3.0, 100.0),
        "airspeed of level flight"},
      R{"min_airspeed_m_s", in_controller(&C::min_airspeed_m_s), "m/s", Range::any(),
        "of the speed guard"}
          .within("from 2 to cruise_m_s",
                  [](const A& a) { return Range::between(2.0, a.flight.controller.cruise_m_s); }),
      R{"min_mission_airspeed_m_s", in_mission(&MissionLimits::min_airspeed_m_s), "m/s",
        Range::any(), "slowest airspeed a mission may ask for"}
          .derived("half-way from min_airspeed_m_s to cruise_m_s",
                   [](A& a) {
                     const C& c = a.flight.controller;
                     a.mission.min_airspeed_m_s = 0.5 * (c.min_airspeed_m_s + c.cruise_m_s);
                   })
          .within("from min_airspeed_m_s to cruise_m_s",
                  [](const A& a) {
                    const C& c = a.flight.controller;
                    return Range::between(c.min_airspeed_m_s, c.cruise_m_s);
                  }),
      R{"max_airspeed_m_s", in_mission(&MissionLimits::max_airspeed_m_s), "m/s", Range::any(),
        "fastest airspeed a mission may ask for"}
          .derived("1.4 cruise_m_s",
                   [](A& a) { a.mission.max_airspeed_m_s = 1.4 * a.flight.controller.cruise_m_s; })
          .within("from cruise_m_s to 150", [](const A& a) {
            return Range::between(a.flight.controller.cruise_m_s, 150.0);
          })};
}

Table<ControllerConfig> attitude_limits() {
  using C = ControllerConfig;
  return {{"roll_deg", &C::max_roll_rad, kDeg, Range::between(10.0, 60.0), "bank"},
          {"roll_rate_deg_s", &C::max_roll_rate_rad_s, kDegPerS, Range::between(10.0, 360.0),
           "of the commanded bank"},
          {"pitch_deg", &C::max_pitch_rad, kDeg, Range::between(5.0, 45.0), "nose up"},
          {"nose_down_deg", &C::min_pitch_rad, kDeg, Range::between(-45.0, -5.0), "nose down"},
          {"alpha_deg", &C::max_alpha_rad, kDeg, Range::between(3.0, 30.0), "of the stall guard"},
          {"climb_deg", &C::max_climb_rad, kDeg, Range::between(1.0, 30.0), "climb angle"},
          {"descent_deg", &C::max_descent_rad, kDeg, Range::between(1.0, 30.0), "descent angle"}};
}

Table<AutonomyConfig> path_limits() {
  using A = AutonomyConfig;
  using P = PlannerConfig;
  using R = Row<A>;
  return {R{"turn_radius_m", in_plan(&P::radius_m), "m", Range::between(5.0, 1000.0),
            "of every turn of a path, in wind the minimum"},
          R{"turn_bank_deg", in_mission(&MissionLimits::max_bank_rad), kDeg,
            Range::between(5.0, 60.0), "of turns of missions, in still air"},
          R{"path_climb_slope", in_plan(&P::climb_slope), "", Range::any(), "of paths"}
              .derived("0.6 tan(climb_deg)",
                       [](A& a) {
                         a.flight.plan.climb_slope =
                             0.6 * std::tan(a.flight.controller.max_climb_rad);
                       })
              .within("from 0.01 to tan(climb_deg)",
                      [](const A& a) {
                        return Range::between(0.01, std::tan(a.flight.controller.max_climb_rad));
                      }),
          R{"path_descent_slope", in_plan(&P::descent_slope), "", Range::any(), "of paths"}
              .derived("0.6 tan(descent_deg)",
                       [](A& a) {
                         a.flight.plan.descent_slope =
                             0.6 * std::tan(a.flight.controller.max_descent_rad);
                       })
              .within("from 0.01 to tan(descent_deg)", [](const A& a) {
                return Range::between(0.01, std::tan(a.flight.controller.max_descent_rad));
              })};
}

Table<MissionArea> area_limits() {
  using M = MissionArea;
  return {{"distance_m", &M::max_distance_m, "m", Range::between(100.0, 100000.0),
           "horizontal distance of a mission from the start"},
          {"height_m", &M::max_height_m, "m", Range::between(10.0, 10000.0),
           "of a mission above the start"},
          {"min_height_m", &M::min_height_m, "m", Range::between(1.0, 500.0),
           "of a mission above the start"}};
}

Table<FlightConfig> follower_table() {
  using F = FollowerConfig;
  const auto f = [](double F::*member) { return at(&FlightConfig::follower, member); };
  return {{"approach_deg", f(&F::approach_rad), kDeg, Range::between(5.0, 89.0),
           "course towards a line from far away"},
          {"line_gain_1_m", f(&F::line_gain_1_m), "1/m", Range::between(1e-4, 1.0),
           "how sharply a line is joined"},
          {"circle_gain", f(&F::circle_gain), "", Range::between(0.1, 20.0),
           "how sharply a circle is joined"},
          {"timeout_s", f(&F::timeout_s), "s", Range::between(0.05, 60.0),
           "age up to which a path is followed"},
          {"lead_s", &FlightConfig::lead_s, "s", Range::between(0.0, 5.0),
           "turns begin this much early"}};
}

Table<ControllerConfig> energy_table() {
  using C = ControllerConfig;
  const auto total = [](auto member) { return at(&C::total_energy, member); };
  const auto loops = [](auto member) { return at(&C::successive_loops, member); };
  return {{"longitudinal",
           &C::longitudinal,
           {{"total_energy", LongitudinalKind::kTotalEnergy},
            {"successive_loops", LongitudinalKind::kSuccessiveLoops}},
           "law that closes height and airspeed"},
          {"energy", total(&TotalEnergyConfig::energy), gains(),
           "total energy: relative energy error to throttle"},
          {"balance", total(&TotalEnergyConfig::balance), gains(),
           "total energy: relative energy difference to climb angle [rad]"},
          {"height", loops(&SuccessiveLoopConfig::height), gains(),
           "successive loops: height to climb angle [rad]"},
          {"airspeed", loops(&SuccessiveLoopConfig::airspeed), gains(),
           "successive loops: airspeed to throttle"},
          {"max_height_error_m", total(&TotalEnergyConfig::max_height_error_m), "m",
           Range::between(1.0, 200.0), "a larger error counts as this"},
          {"throttle_cruise", &C::throttle_cruise, "", Range::between(0.0, 1.0),
           "of level flight at cruise"},
          {"throttle_per_climb", &C::throttle_per_climb, "1/rad", Range::between(0.0, 20.0),
           "fed forward per climb angle"},
          {"throttle_per_speed_s_m", &C::throttle_per_speed_s_m, "s/m", Range::between(0.0, 1.0),
           "fed forward per airspeed above cruise"},
          {"throttle_per_load", &C::throttle_per_load, "", Range::between(0.0, 5.0),
           "fed forward per load factor beyond 1"},
          Row<C>{"min_throttle", &C::min_throttle, "", Range::between(0.0, 0.9), ""}.must(
              "less than max_throttle", [](const C& c) { return c.min_throttle < c.max_throttle; }),
          {"max_throttle", &C::max_throttle, "", Range::between(0.1, 1.0), ""}};
}

Table<ControllerConfig> controller_table() {
  using C = ControllerConfig;
  return {
      {"course", &C::course, gains(), "course to bank"},
      {"roll", &C::roll, gains(), "bank to aileron at cruise"},
      {"pitch", &C::pitch, gains(), "pitch to elevator at cruise"},
      {"ground_course", &C::ground_course, gains(), "course to rudder on the ground"},
      {"roll_by_rudder", &C::roll_by_rudder, gains(), "bank to rudder, once the ailerons are lost"},
      {"climb_rate", &C::climb_rate, gains(), "climb rate to pitch in the flare"},
      {"glide", &C::glide, gains(), "airspeed to pitch of a glide without motor"},
      {"glide_deg", &C::glide_rad, kDeg, Range::between(-30.0, 0.0), "angle a glide starts from"},
      {"full_aileron_rad_s", &C::full_aileron_rad_s, "rad/s", Range::between(0.0, 30.0),
       "roll rate of full ailerons at cruise; with less than a tenth they count as lost; 0: never"},
      {"yaw_damper_s", &C::yaw_damper_s, "s", Range::between(0.0, 10.0),
       "yaw rate to rudder at cruise"},
      {"yaw_washout_rad_s", &C::yaw_washout_rad_s, "rad/s", Range::between(0.0, 50.0),
       "corner of the yaw damper's washout"},
      {"pitch_trim_deg", at(&C::airframe, &Airframe::pitch_trim_rad), kDeg,
       Range::between(-10.0, 15.0), "of level flight, where lift is not known"},
      {"speed_guard_rad_s_m", &C::speed_guard_rad_s_m, "rad s/m", Range::between(0.0, 1.0),
       "nose down per airspeed below min_airspeed_m_s"},
      {"command_timeout_s", &C::command_timeout_s, "s", Range::between(0.05, 60.0),
       "age up to which a command is followed"},
      {"lost_roll_deg", &C::lost_roll_rad, kDeg, Range::between(-45.0, 45.0),
       "bank without a command"}};
}

Table<TakeoffConfig> takeoff_table() {
  using T = TakeoffConfig;
  return {
      Row<T>{"height_m", &T::height_m, "m", Range::between(5.0, 500.0), "climb straight up to this"}
          .must("more than airborne_m and margin_m together",
                [](const T& t) { return t.airborne_m + t.margin_m < t.height_m; }),
      {"rotate_m_s", &T::rotate_m_s, "m/s", Range::between(0.0, 100.0),
       "airspeed at which the nose is raised"},
      {"pitch_deg", &T::pitch_rad, kDeg, Range::between(0.0, 30.0), "of the climb"},
      {"ramp_s", &T::ramp_s, "s", Range::between(0.05, 20.0), "of the throttle"},
      {"airborne_m", &T::airborne_m, "m", Range::between(0.5, 50.0),
       "higher it counts as airborne"},
      {"timeout_s", &T::timeout_s, "s", Range::between(1.0, 600.0), "then take-off is given up"},
      {"margin_m", &T::margin_m, "m", Range::between(0.5, 20.0),
       "take-off ends this far below its height"}};
}

Table<FlightConfig> landing_table() {
  using L = LandingConfig;
  const auto l = [](double L::*member) { return at(&FlightConfig::landing, member); };
  return {
      {"approach_height_m", l(&L::approach_height_m), "m", Range::between(5.0, 300.0),
       "above the aim point, where the glide path begins"},
      {"glide_slope", l(&L::glide_slope), "", Range::between(0.02, 0.5),
       "at most limits.path_descent_slope"},
      Row<FlightConfig>{"level_m", l(&L::level_m), "m", Range::any(),
                        "straight and level before the glide path"}
          .derived("120, at least 1.5 limits.turn_radius_m",
                   [](FlightConfig& f) {
                     f.landing.level_m = std::max(f.landing.level_m, 1.5 * f.plan.radius_m);
                   })
          .within("from limits.turn_radius_m to 5000",
                  [](const FlightConfig& f) { return Range::between(f.plan.radius_m, 5000.0); }),
      {"airspeed_m_s", l(&L::airspeed_m_s), "m/s", Range::between(2.0, 100.0), "on the glide path"},
      {"flare_time_s", l(&L::flare_time_s), "s", Range::between(0.2, 10.0),
       "time constant of the flare"},
      {"touchdown_m_s", l(&L::touchdown_m_s), "m/s", Range::between(0.05, 3.0),
       "sink rate the flare ends with"},
      {"flare_throttle", l(&L::flare_throttle), "", Range::between(0.0, 1.0),
       "reached at the end of the flare; idle on the ground"},
      {"roll_deg", l(&L::max_roll_rad), kDeg, Range::between(1.0, 45.0), "in the flare"},
      {"pitch_deg", l(&L::max_pitch_rad), kDeg, Range::between(1.0, 30.0), "in the flare"}};
}

Table<SafetyConfig> safety_table() {
  using S = SafetyConfig;
  return {{"dead_reckoning_s", &S::dead_reckoning_s, "s", Range::between(0.0, 600.0),
           "a position without aiding is followed this long"},
          {"position_wait_s", &S::position_wait_s, "s", Range::between(0.0, 3600.0),
           "from the last aided position; then it comes down where it is"},
          {"descent_m_s", &S::descent_m_s, "m/s", Range::between(0.3, 5.0),
           "sink rate of that descent"},
          {"return_height_m", &S::return_height_m, "m", Range::between(5.0, 1000.0),
           "of the return, above the start"},
          {"motor_out_s", &S::motor_out_s, "s", Range::between(0.5, 60.0),
           "full throttle and losing energy for this long: the motor has failed"},
          {"motor_out_m_s", &S::motor_out_m_s, "m/s", Range::between(0.0, 10.0),
           "energy lost per weight, as a sink rate"},
          {"glide_m_s", &S::glide_m_s, "m/s", Range::between(2.0, 100.0),
           "airspeed of a glide without motor"},
          {"glide_ratio", &S::glide_ratio, "", Range::between(2.0, 60.0),
           "distance per height of that glide, in still air"},
          {"straight_below_m", &S::straight_below_m, "m", Range::between(0.0, 200.0),
           "a glide does not turn below this height"},
          Row<S>{"max_range_m", &S::max_range_m, "m", Range::between(0.0, 200.0),
                 "larger readings of the range sensor are not used"}
              .formerly("longest_range_m")};
}

/// Values that several parts share.
void share(AutonomyConfig& out) {
  ControllerConfig& c = out.flight.controller;
  PlannerConfig& plan = out.flight.plan;
  c.successive_loops.max_height_error_m = c.total_energy.max_height_error_m;
  c.total_energy.gravity_m_s2 = c.airframe.gravity_m_s2;
  plan.airspeed_m_s = c.cruise_m_s;
  out.flight.follower.max_roll_ff_rad = c.max_roll_rad;
  out.flight.follower.gravity_m_s2 = c.airframe.gravity_m_s2;
  out.mission.plan = plan;
  out.mission.gravity_m_s2 = c.airframe.gravity_m_s2;
}

/// Conditions between sections.
void check(const Section& autonomy, const AutonomyConfig& out) {
  const config::Document nothing = config::Document::from_text("{}", "defaults");
  const auto section = [&](std::string_view key) {
    return autonomy.optional_section(key).value_or(nothing.root());
  };
  const PlannerConfig& plan = out.flight.plan;
  const double cruise_m_s = out.flight.controller.cruise_m_s;
  const double max_bank_rad = out.mission.max_bank_rad;
  const double bank =
      std::atan(cruise_m_s * cruise_m_s / (out.mission.gravity_m_s2 * plan.radius_m));
  if (bank > max_bank_rad || max_bank_rad > out.flight.controller.max_roll_rad) {
    throw section("limits").error("turn_radius_m",
                                  number_text(plan.radius_m) + ", at cruise a bank of " +
                                      number_text(std::round(bank / kRadPerDeg)) + " deg",
                                  "at most turn_bank_deg, and that at most roll_deg");
  }
  if (out.flight.landing.glide_slope > plan.descent_slope) {
    const Section in = section("landing");
    throw in.error("glide_slope", in.raw("glide_slope"),
                   "at most limits.path_descent_slope of " + number_text(plan.descent_slope));
  }
}

Airframe airframe_of(const VehicleFacts& vehicle, double elevator_travel_rad,
                     double pitch_trim_rad) {
  Airframe out;
  out.pitch_trim_rad = pitch_trim_rad;
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

Table<AutonomyConfig> parameters() {
  using A = AutonomyConfig;
  using F = FlightConfig;
  return {{"elevator_travel_deg", &A::elevator_travel_rad, kDeg, Range::between(0.0, 90.0),
           "deflection at a pitch command of 1; 0: the trim is left to the integral"},
          {"limits", [](A& a) -> A& { return a; }, speed_limits()},
          {"limits", at(&A::flight, &F::controller), attitude_limits()},
          {"limits", [](A& a) -> A& { return a; }, path_limits()},
          {"limits", at(&A::mission, &MissionLimits::area), area_limits()},
          {"energy", at(&A::flight, &F::controller), energy_table(), "Height and airspeed."},
          {"controller", at(&A::flight, &F::controller), controller_table(),
           "Course, attitude, and what is flown without commands."},
          {"follower", &A::flight, follower_table(), "Follows paths."},
          {"takeoff", at(&A::flight, &F::takeoff), takeoff_table()},
          {"landing", &A::flight, landing_table()},
          {"safety", at(&A::flight, &F::safety), safety_table()},
          {"battery", at(&A::flight, &F::battery), battery_table(),
           "Cells, capacity and resistance come from the section `battery`."}};
}

AutonomyConfig read_autonomy(const Section& autonomy, const VehicleFacts& vehicle) {
  AutonomyConfig out;
  parameters().read(autonomy, out);
  Airframe& airframe = out.flight.controller.airframe;
  out.flight.battery.cells = vehicle.battery.cells;
  out.flight.battery.capacity_Ah = vehicle.battery.capacity_Ah;
  out.flight.battery.resistance_ohm = vehicle.battery.resistance_ohm;
  airframe = airframe_of(vehicle, out.elevator_travel_rad, airframe.pitch_trim_rad);
  share(out);
  check(autonomy, out);
  static_cast<void>(autonomy.foreign_section("estimator"));  // estimation/read_estimator.hpp
  autonomy.finish();
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
