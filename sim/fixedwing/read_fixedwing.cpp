// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include "base/constants.hpp"
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight::sim {
namespace {

using config::Range;
using config::Section;

using base::kRadPerDeg;
constexpr Range kDerivative = Range::between(-1000.0, 1000.0);

/// Every derivative must be there: a missing one is a slip, not a zero.
double derivative(const Section& section, std::string_view key) {
  return section.number(key, kDerivative);
}

SymmetricDerivatives read_symmetric(const Section& s) {
  return {derivative(s, "zero"), derivative(s, "alpha"), derivative(s, "q"),
          derivative(s, "elevator")};
}

LateralDerivatives read_lateral(const Section& s) {
  return {derivative(s, "zero"), derivative(s, "beta"),    derivative(s, "p"),
          derivative(s, "r"),    derivative(s, "aileron"), derivative(s, "rudder")};
}

DragDerivatives read_drag(const Section& s) {
  return {s.number("parasitic", Range::between(0.0, 10.0)), derivative(s, "q"),
          derivative(s, "elevator")};
}

std::vector<SurfaceParameters> read_layout(const Section& surfaces,
                                           const MultirotorParameters& propulsion) {
  const auto list = surfaces.sections("layout");
  if (list.empty() || list.size() > hal::kOutputs) {
    throw surfaces.error("layout", std::to_string(list.size()) + " surfaces",
                         "1 to " + std::to_string(hal::kOutputs));
  }
  std::vector<SurfaceParameters> all;
  const Range share = Range::between(-10.0, 10.0);
  for (const Section& entry : list) {
    SurfaceParameters surface;
    surface.output = static_cast<std::size_t>(entry.integer("output", 0, hal::kOutputs - 1));
    bool taken = false;
    for (const auto& other : all) taken = taken || other.output == surface.output;
    for (const auto& rotor : propulsion.rotors) taken = taken || rotor.output == surface.output;
    if (taken) {
      throw entry.error("output", entry.raw("output") + " again",
                        "each output once, rotors included");
    }
    surface.travel_rad = kRadPerDeg * entry.number("travel_deg", Range::positive_up_to(90.0));
    surface.effect = {entry.number("aileron", share, 0.0), entry.number("elevator", share, 0.0),
                      entry.number("rudder", share, 0.0)};
    if (surface.effect.isZero(0.0)) {
      throw entry.error("no effect", "aileron, elevator or rudder other than 0");
    }
    all.push_back(surface);
  }
  return all;
}

}  // namespace

AirframeParameters read_airframe(const Section& section) {
  AirframeParameters p;
  p.model = section.choice<AeroModel>(
      "model", {{"stall", AeroModel::kStall}, {"reference", AeroModel::kReference}},
      AeroModel::kStall);
  const Section wing = section.section("wing");
  p.area_m2 = wing.number("area_m2", Range::positive_up_to(1e4));
  p.span_m = wing.number("span_m", Range::positive_up_to(1e3));
  p.chord_m = wing.number("chord_m", Range::positive_up_to(1e2));
  p.oswald = wing.number("oswald", Range::positive_up_to(1.5));
  const Section stall = section.section("stall");
  p.stall_angle_rad = kRadPerDeg * stall.number("angle_deg", Range::positive_up_to(90.0));
  p.stall_sharpness = stall.number("sharpness_1_rad", Range::positive_up_to(1000.0));
  p.lift = read_symmetric(section.section("lift"));
  if (!(p.lift.alpha > 0.0))
    throw section.section("lift").error("alpha", config::number_text(p.lift.alpha), "a number > 0");
  p.drag = read_drag(section.section("drag"));
  p.pitch = read_symmetric(section.section("pitch"));
  p.side = read_lateral(section.section("side"));
  p.roll = read_lateral(section.section("roll"));
  p.yaw = read_lateral(section.section("yaw"));
  section.finish();
  return p;
}

FixedWingParameters read_fixed_wing(const Section& vehicle) {
  FixedWingParameters p;
  p.propulsion = read_propulsion(vehicle);
  p.airframe = read_airframe(vehicle.section("aero"));
  const Section surfaces = vehicle.section("surfaces");
  p.servo_time_constant_s = surfaces.number("time_constant_s", Range::between(0.0, 1.0));
  // Shorter ones need smaller steps than 2.5 ms.
  if (p.servo_time_constant_s > 0.0 && p.servo_time_constant_s < 0.002)
    throw surfaces.error("time_constant_s", surfaces.raw("time_constant_s"),
                         "0 or a number from 0.002 to 1");
  p.servo_rate_limit_rad_s =
      kRadPerDeg * surfaces.number("rate_limit_deg_s", Range::positive_up_to(1e5));
  p.surfaces = read_layout(surfaces, p.propulsion);
  surfaces.finish();
  const std::size_t states = p.propulsion.rotors.size() + 1 + p.surfaces.size();
  if (states > ForcesAndMoments::kMaxStates) {
    throw surfaces.error("layout", std::to_string(p.surfaces.size()) + " surfaces",
                         "rotors and surfaces with no more than " +
                             std::to_string(ForcesAndMoments::kMaxStates - 1) + " in all");
  }
  return p;
}

}  // namespace rosflight::sim
