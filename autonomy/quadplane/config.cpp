// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/config.hpp"

#include <cmath>

#include "config/table.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

using config::at;
using config::kDeg;
using config::kDegPerS;
using config::Range;
using config::Table;

using A = AutonomyConfig;

template <class M>
auto flight(M member) {
  return at(&A::flight, member);
}

Table<A> limits_table() {
  using F = FlightConfig;
  return {{"cruise_m_s", flight(&F::cruise_m_s), "m/s", Range::between(3.0, 100.0),
           "airspeed between the transitions"},
          {"wing_only_stalls", flight(&F::wing_only_stalls), "stall speeds",
           Range::between(1.0, 2.0), "lower end of flight on the wing alone"},
          {"acceleration_m_s2", flight(&F::acceleration_m_s2), "m/s^2", Range::between(0.2, 5.0),
           "along the path, in the transition forward"},
          {"deceleration_m_s2", flight(&F::deceleration_m_s2), "m/s^2", Range::between(0.2, 5.0),
           "along the path, in the transition back"},
          {"bank_deg", flight(&F::max_bank_rad), kDeg, Range::between(5.0, 60.0), "bank"},
          {"hover_tilt_deg", flight(&F::max_hover_tilt_rad), kDeg, Range::between(1.0, 30.0),
           "nose up, to brake on the rotors"},
          {"alpha_deg", flight(&F::max_alpha_rad), kDeg, Range::between(1.0, 15.0),
           "angle of attack that is commanded; the rotors carry the rest"},
          {"yaw_rate_deg_s", flight(&F::yaw_rate_rad_s), kDegPerS, Range::between(5.0, 180.0),
           "of the commanded heading"},
          {"turn_radius_m", at(&A::mission, &MissionLimits::turn_radius_m), "m",
           Range::between(10.0, 1000.0), "of every corner"},
          {"distance_m", at(&A::mission, &MissionLimits::area, &MissionArea::max_distance_m), "m",
           Range::between(1.0, 100000.0), "horizontal distance of a mission from the start"},
          {"height_m", at(&A::mission, &MissionLimits::area, &MissionArea::max_height_m), "m",
           Range::between(1.0, 10000.0), "of a mission above the start"},
          {"min_height_m", at(&A::mission, &MissionLimits::area, &MissionArea::min_height_m), "m",
           Range::between(-1000.0, 100.0), "of a mission above the start"}};
}

Table<A> loops_table() {
  using F = FlightConfig;
  const Range gain = Range::between(0.0, 100.0);
  return {
      {"roll_pitch_1_s", flight(&F::roll_pitch_1_s), "1/s", gain, "attitude to rate"},
      {"roll_pitch_rate_1_s", flight(&F::roll_pitch_rate_1_s), "1/s", gain,
       "rate to angular acceleration"},
      {"yaw_1_s", flight(&F::yaw_1_s), "1/s", gain, "heading to rate"},
      {"yaw_rate_1_s", flight(&F::yaw_rate_1_s), "1/s", gain, "rate to angular acceleration"},
      {"position_1_s", flight(&F::position_1_s), "1/s", gain, "across the path, to speed"},
      {"velocity_1_s", flight(&F::velocity_1_s), "1/s", gain, "horizontal, to acceleration"},
      {"vertical_1_s", flight(&F::vertical_1_s), "1/s", gain, "height to climb"},
      {"vertical_speed_1_s", flight(&F::vertical_speed_1_s), "1/s", gain, "climb to acceleration"}};
}

Table<A> takeoff_table() {
  return {{"height_m", at(&A::mission, &MissionLimits::takeoff_height_m), "m",
           Range::between(2.0, 500.0), "where the transition begins, unless the mission says"},
          {"speed_m_s", flight(&FlightConfig::takeoff_speed_m_s), "m/s", Range::between(0.2, 10.0),
           "climb"}};
}

Table<multirotor::LandingConfig> landing_table() {
  using L = multirotor::LandingConfig;
  return {{"speed_m_s", &L::speed_m_s, "m/s", Range::between(0.1, 5.0), "of the descent"},
          config::Row<L>{"touchdown_speed_m_s", &L::touchdown_speed_m_s, "m/s",
                         Range::between(0.1, 1.0), "at the height of the start"}
              .must("at most speed_m_s",
                    [](const L& l) { return l.touchdown_speed_m_s <= l.speed_m_s; }),
          {"slow_height_m", &L::slow_height_m, "m", Range::between(0.1, 100.0),
           "slows down from here to the height of the start"}};
}

}  // namespace

double VehicleFacts::stall_speed_m_s() const {
  return std::sqrt(2.0 * mass_kg * gravity_m_s2 / (density_kg_m3 * wing_area_m2 * lift_max));
}

Table<A> parameters() {
  const auto self = [](A& a) -> A& { return a; };
  return {{"limits", self, limits_table()},
          {"loops", self, loops_table(), "Each is the bandwidth of its loop."},
          {"takeoff", self, takeoff_table()},
          {"landing", flight(&FlightConfig::landing), landing_table()},
          {"battery", flight(&FlightConfig::battery), battery_table(),
           "Cells, capacity and resistance come from the section `battery`."}};
}

AutonomyConfig read_autonomy(const config::Section& autonomy, const VehicleFacts& vehicle) {
  AutonomyConfig out;
  parameters().read(autonomy, out);
  out.flight.vehicle = vehicle;
  out.flight.battery.cells = vehicle.battery.cells;
  out.flight.battery.capacity_Ah = vehicle.battery.capacity_Ah;
  out.flight.battery.resistance_ohm = vehicle.battery.resistance_ohm;
  const double weight_N = vehicle.mass_kg * vehicle.gravity_m_s2;
  constexpr double kMinLift = 1.3;  // the rest turns and brakes
  if (vehicle.max_lift_force_N < kMinLift * weight_N) {
    throw autonomy.error("lifting rotors of " + config::number_text(vehicle.max_lift_force_N) +
                             " N for a weight of " + config::number_text(weight_N) + " N",
                         "1.3 weights and more");
  }
  const double wing_only_m_s = out.flight.wing_only_stalls * vehicle.stall_speed_m_s();
  if (out.flight.cruise_m_s < wing_only_m_s) {
    throw autonomy.error(
        "limits.cruise_m_s", config::number_text(out.flight.cruise_m_s),
        "at least wing_only_stalls stall speeds, " + config::number_text(wing_only_m_s));
  }
  static_cast<void>(autonomy.foreign_section("estimator"));  // estimation/read_estimator.hpp
  autonomy.finish();
  return out;
}

}  // namespace rosflight::autonomy::quadplane
