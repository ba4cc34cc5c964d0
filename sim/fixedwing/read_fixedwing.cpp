// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>

#include "config/table.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/parameter_tables.hpp"

namespace rosflight::sim {
namespace {

using config::kDeg;
using config::kDegPerS;
using config::Range;
using config::Row;
using config::Section;
using config::Table;
using config::Whole;

/// Every derivative must be there: a missing one is a slip, not a zero.
template <class S>
Row<S> derivative(std::string_view key, double S::*member, std::string_view text = {}) {
  return Row<S>{key, member, "", Range::between(-1000.0, 1000.0), text}.needed();
}

Table<SymmetricDerivatives> symmetric_table() {
  using D = SymmetricDerivatives;
  return {derivative("zero", &D::zero), derivative("alpha", &D::alpha, "per radian"),
          derivative("q", &D::q, "by q c/2V"),
          derivative("elevator", &D::elevator, "per radian, trailing edge down")};
}

Table<SymmetricDerivatives> lift_table() {
  using D = SymmetricDerivatives;
  return {derivative("zero", &D::zero),
          derivative("alpha", &D::alpha, "per radian")
              .must("a number > 0", [](const D& d) { return d.alpha > 0.0; }),
          derivative("q", &D::q, "by q c/2V"),
          derivative("elevator", &D::elevator, "per radian, trailing edge down")};
}

Table<DragDerivatives> drag_table() {
  using D = DragDerivatives;
  return {
      Row<D>{"parasitic", &D::parasitic, "", Range::between(0.0, 10.0), "without lift"}.needed(),
      derivative("q", &D::q, "by q c/2V"), derivative("elevator", &D::elevator, "per radian")};
}

Table<LateralDerivatives> lateral_table() {
  using D = LateralDerivatives;
  return {derivative("zero", &D::zero),
          derivative("beta", &D::beta, "per radian"),
          derivative("p", &D::p, "by p b/2V"),
          derivative("r", &D::r, "by r b/2V"),
          derivative("aileron", &D::aileron, "per radian"),
          derivative("rudder", &D::rudder, "per radian")};
}

Table<AirframeParameters> wing_table() {
  using A = AirframeParameters;
  using R = Row<A>;
  return {R{"area_m2", &A::area_m2, "m^2", Range::positive_up_to(1e4), ""}.needed(),
          R{"span_m", &A::span_m, "m", Range::positive_up_to(1e3), ""}.needed(),
          R{"chord_m", &A::chord_m, "m", Range::positive_up_to(1e2), "mean"}.needed(),
          R{"oswald", &A::oswald, "", Range::positive_up_to(1.5), "efficiency"}.needed()};
}

Table<AirframeParameters> stall_table() {
  using A = AirframeParameters;
  using R = Row<A>;
  return {R{"angle_deg", &A::stall_angle_rad, kDeg, Range::positive_up_to(90.0), ""}.needed(),
          R{"sharpness_1_rad", &A::stall_sharpness, "1/rad", Range::positive_up_to(1000.0),
            "of the change from attached to separated flow"}
              .needed()};
}

Table<SurfaceParameters> surface_table() {
  using P = SurfaceParameters;
  using R = Row<P>;
  const auto effect = [](int i) { return [i](P& p) -> double& { return p.effect(i); }; };
  const Range share = Range::between(-10.0, 10.0);
  return {
      R{"output", &P::output, "", Whole{0, hal::kOutputs - 1},
        "of the firmware, drives it; each output once, rotors included"}
          .needed(),
      R{"travel_deg", &P::travel_rad, kDeg, Range::positive_up_to(90.0), "at either end"}.needed(),
      R{"aileron", effect(0), "", share, "that a deflection of 1 amounts to"}.if_absent("0"),
      R{"elevator", effect(1), "", share, "likewise"}.if_absent("0"),
      R{"rudder", effect(2), "", share, "likewise; one of the three is not 0"}.if_absent("0")};
}

void check_layout(const Section& surfaces, const FixedWingParameters& p) {
  const auto layout = surfaces.sections("layout");
  for (std::size_t i = 0; i < layout.size(); ++i) {
    const std::size_t output = p.surfaces[i].output;
    bool taken = false;
    for (std::size_t k = 0; k < i; ++k) taken = taken || p.surfaces[k].output == output;
    for (const auto& rotor : p.propulsion.rotors) {
      taken = taken || rotor.output == output || (rotor.tilt && rotor.tilt->output == output);
    }
    if (taken) {
      throw layout[i].error("output", layout[i].raw("output") + " again",
                            "each output once, rotors included");
    }
    if (p.surfaces[i].effect.isZero(0.0))
      throw layout[i].error("no effect", "aileron, elevator or rudder other than 0");
  }
}

}  // namespace

Table<AirframeParameters> airframe_parameters() {
  using A = AirframeParameters;
  using R = Row<A>;
  const auto self = [](A& a) -> A& { return a; };
  return {{"model",
           &A::model,
           {{"stall", AeroModel::kStall}, {"reference", AeroModel::kReference}},
           "reference: as ROSflight 2.x"},
          {"ground_effect",
           &A::ground_effect,
           {{"none", WingGroundEffect::kNone}, {"mccormick", WingGroundEffect::kMcCormick}},
           "mccormick: less induced drag within a span of the ground"},
          R{"wing", self, wing_table()}.needed(),
          R{"stall", self, stall_table()}.needed(),
          R{"lift", &A::lift, lift_table()}.needed(),
          R{"drag", &A::drag, drag_table()}.needed(),
          R{"pitch", &A::pitch, symmetric_table()}.needed(),
          R{"side", &A::side, lateral_table()}.needed(),
          R{"roll", &A::roll, lateral_table()}.needed(),
          R{"yaw", &A::yaw, lateral_table()}.needed()};
}

Table<FixedWingParameters> surface_parameters() {
  using P = FixedWingParameters;
  using R = Row<P>;
  // Shorter time constants need smaller steps than 2.5 ms.
  return {R{"time_constant_s", &P::servo_time_constant_s, "s", Range::between(0.0, 1.0),
            "of every servo; 0: deflections follow at once"}
              .needed()
              .only("0 or a number from 0.002 to 1",
                    [](double tau) { return tau == 0.0 || tau >= 0.002; }),
          R{"rate_limit_deg_s", &P::servo_rate_limit_rad_s, kDegPerS, Range::positive_up_to(1e5),
            "of every servo"}
              .needed(),
          {"layout", &P::surfaces, surface_table(), Whole{1, hal::kOutputs},
           "one entry per surface. An inverted V-tail: -1 and 1 as elevator, 1 and 1 as rudder; "
           "elevons: elevator and aileron"}};
}

AirframeParameters read_airframe(const Section& section) {
  AirframeParameters p;
  airframe_parameters().read(section, p);
  section.finish();
  return p;
}

FixedWingParameters read_fixed_wing(const Section& vehicle) {
  FixedWingParameters p;
  p.propulsion = read_propulsion(vehicle);
  p.airframe = read_airframe(vehicle.section("aero"));
  p.airframe.centre_B = -centre_of_mass(vehicle);
  const Section surfaces = vehicle.section("surfaces");
  surface_parameters().read(surfaces, p);
  check_layout(surfaces, p);
  surfaces.finish();
  const auto tilts = static_cast<std::size_t>(
      std::ranges::count_if(p.propulsion.rotors, [](const auto& r) { return r.tilt.has_value(); }));
  const std::size_t states = p.propulsion.rotors.size() + 1 + tilts + p.surfaces.size();
  if (states > ForcesAndMoments::kMaxStates) {
    throw surfaces.error("layout", std::to_string(p.surfaces.size()) + " surfaces",
                         "rotors and surfaces with no more than " +
                             std::to_string(ForcesAndMoments::kMaxStates - 1) + " in all");
  }
  return p;
}

}  // namespace rosflight::sim
