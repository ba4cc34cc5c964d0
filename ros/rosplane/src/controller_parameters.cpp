// SPDX-License-Identifier: BSD-3-Clause
#include "rosplane/controller_parameters.hpp"

#include <string>
#include <string_view>

namespace rosplane {
namespace {

using autonomy::PidGains;
using autonomy::fixedwing::ControllerConfig;
using autonomy::fixedwing::FlightConfig;
using config::at;
using config::kDeg;
using config::Range;
using C = FixedWingConfig;

/// A setting of the controller.
template <class... Members>
auto in_controller(Members... members) {
  return at(&C::flight, &FlightConfig::controller, members...);
}

/// kp and ki under `prefix`, and kd.
template <class... Members>
FixedWingRow gains(const char* prefix, std::string_view text, Members... members) {
  return rosflight_common::gains_row<C>(prefix, in_controller(members...), "",
                                        Range::between(0.0, 100.0), text);
}

template <class Member>
FixedWingRow two_gains(const char* prefix, std::string_view text, Member member) {
  const std::string name = prefix;
  const Range allowed = Range::between(0.0, 100.0);
  return {"", in_controller(member),
          config::Table<PidGains>{{name + "_kp", &PidGains::kp, "", allowed, text},
                                  {name + "_ki", &PidGains::ki, "", allowed, text}}};
}

FixedWingTable all_gains() {
  using K = ControllerConfig;
  using Energy = autonomy::fixedwing::TotalEnergyConfig;
  using Loops = autonomy::fixedwing::SuccessiveLoopConfig;
  return {
      two_gains("c", "gain from course to bank", &K::course),
      gains("r", "gain from bank to aileron at cruise", &K::roll),
      gains("p", "gain from pitch to elevator at cruise", &K::pitch),
      gains("a_t", "gain from airspeed to throttle, successive loops", &K::successive_loops,
            &Loops::airspeed),
      gains("a", "gain from height to climb angle, successive loops", &K::successive_loops,
            &Loops::height),
      gains("e", "gain from energy to throttle, total energy", &K::total_energy, &Energy::energy),
      gains("l", "gain from balance to climb angle, total energy", &K::total_energy,
            &Energy::balance),
      {"y_kr", in_controller(&K::yaw_damper_s), "s", Range::between(0.0, 10.0),
       "gain from yaw rate to rudder at cruise"},
      {"y_pwo", in_controller(&K::yaw_washout_rad_s), "rad/s", Range::between(0.0, 50.0),
       "corner frequency of the yaw damper's washout"}};
}

FixedWingTable limits() {
  using K = ControllerConfig;
  using autonomy::fixedwing::Airframe;
  return {
      {"max_roll", in_controller(&K::max_roll_rad), kDeg, Range::between(5.0, 60.0),
       "maximum bank"},
      {"max_pitch", in_controller(&K::max_pitch_rad), kDeg, Range::between(5.0, 45.0),
       "maximum pitch"},
      {"max_t", in_controller(&K::max_throttle), "", Range::between(0.1, 1.0), "maximum throttle"},
      {"trim_t", in_controller(&K::throttle_cruise), "", Range::between(0.0, 1.0),
       "throttle of level flight at cruise"},
      {"max_alt_error",
       [](const C& c) { return c.flight.controller.total_energy.max_height_error_m; },
       [](C& c, double x) {
         c.flight.controller.total_energy.max_height_error_m = x;
         c.flight.controller.successive_loops.max_height_error_m = x;
       },
       "m", Range::between(1.0, 200.0), "height error is limited to this"},
      {"mass", in_controller(&K::airframe, &Airframe::mass_kg), "kg", Range::between(0.1, 1000.0),
       "mass of the aircraft"},
      {"gravity", [](const C& c) { return c.flight.controller.airframe.gravity_m_s2; },
       [](C& c, double x) {
         c.flight.controller.airframe.gravity_m_s2 = x;
         c.flight.controller.total_energy.gravity_m_s2 = x;
       },
       "m/s^2", Range::between(9.0, 10.0), "gravity"}};
}

FixedWingTable takeoff() {
  using autonomy::fixedwing::TakeoffConfig;
  using autonomy::fixedwing::ZoneConfig;
  return {{"alt_toz", at(&C::zones, &ZoneConfig::takeoff_m), "m", Range::between(0.5, 500.0),
           "height of the take-off without a path manager"},
          {"alt_hz", at(&C::zones, &ZoneConfig::hold_m), "m", Range::between(0.5, 500.0),
           "distance below the commanded height at which that climb ends"},
          {"max_takeoff_throttle", &C::max_takeoff_throttle, "", Range::between(0.1, 1.0),
           "maximum throttle until airborne"},
          {"cmd_takeoff_pitch", at(&C::flight, &FlightConfig::takeoff, &TakeoffConfig::pitch_rad),
           kDeg, Range::between(0.0, 30.0), "pitch of the take-off without a path manager"},
          {"roll_command_override", &C::roll_override,
           "uses phi_c of the command instead of the course loop"},
          {"pitch_command_override", &C::pitch_override,
           "uses theta_c of the command instead of the height loop"}};
}

}  // namespace

FixedWingTable controller_parameters() {
  const auto all = [](C& c) -> C& { return c; };
  return {{"controller_output_frequency", &C::rate_Hz, "Hz", Range::between(10.0, 1000.0),
           "maximum commands per second"},
          {"", all, all_gains()},
          {"", all, limits()},
          {"", all, takeoff()}};
}

}  // namespace rosplane
