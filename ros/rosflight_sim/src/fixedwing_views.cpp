// SPDX-License-Identifier: BSD-3-Clause
// Parameters of ROSflight 2.x's fixed-wing forces node. Those that its equations never used
// (wing_epsilon apart, which is the Oswald factor here) are not there.

#include "base/constants.hpp"
#include "rosflight_sim/view_tools.hpp"
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;
namespace sim = rosflight::sim;

using namespace views;

namespace {

using base::kDegPerRad;

/// One number of the vehicle file, with the parameter's unit times `scale` as the file's.
struct Entry {
  const char* name;
  const char* key;
  double min, max;
  const char* what;
  double (*get)(const sim::AirframeParameters&);
  double scale{1.0};
};

using Airframe = sim::AirframeParameters;

constexpr double kAny = 1000.0;

const Entry kEntries[] = {
    {"wing_s", "aero.wing.area_m2", 1e-3, 1e4, "area of the wing [m^2]",
     [](const Airframe& a) { return a.area_m2; }},
    {"wing_b", "aero.wing.span_m", 1e-3, 1e3, "its span [m]",
     [](const Airframe& a) { return a.span_m; }},
    {"wing_c", "aero.wing.chord_m", 1e-3, 1e2, "its chord [m]",
     [](const Airframe& a) { return a.chord_m; }},
    {"wing_epsilon", "aero.wing.oswald", 1e-3, 1.5, "Oswald factor",
     [](const Airframe& a) { return a.oswald; }},
    {"wing_M", "aero.stall.sharpness_1_rad", 1e-3, 1e3, "sharpness of the stall [1/rad]",
     [](const Airframe& a) { return a.stall_sharpness; }},
    {"wing_alpha0", "aero.stall.angle_deg", 1e-3, 1.57, "angle of attack of the stall [rad]",
     [](const Airframe& a) { return a.stall_angle_rad; }, kDegPerRad},
    {"C_L_O", "aero.lift.zero", -kAny, kAny, "lift", [](const Airframe& a) { return a.lift.zero; }},
    {"C_L_alpha", "aero.lift.alpha", 1e-6, kAny, "lift by angle of attack",
     [](const Airframe& a) { return a.lift.alpha; }},
    {"C_L_q", "aero.lift.q", -kAny, kAny, "lift by pitch rate",
     [](const Airframe& a) { return a.lift.q; }},
    {"C_L_delta_e", "aero.lift.elevator", -kAny, kAny, "lift by elevator",
     [](const Airframe& a) { return a.lift.elevator; }},
    {"C_D_p", "aero.drag.parasitic", 0.0, 10.0, "drag without lift",
     [](const Airframe& a) { return a.drag.parasitic; }},
    {"C_D_q", "aero.drag.q", -kAny, kAny, "drag by pitch rate",
     [](const Airframe& a) { return a.drag.q; }},
    {"C_D_delta_e", "aero.drag.elevator", -kAny, kAny, "drag by elevator",
     [](const Airframe& a) { return a.drag.elevator; }},
    {"C_m_O", "aero.pitch.zero", -kAny, kAny, "pitch moment",
     [](const Airframe& a) { return a.pitch.zero; }},
    {"C_m_alpha", "aero.pitch.alpha", -kAny, kAny, "pitch moment by angle of attack",
     [](const Airframe& a) { return a.pitch.alpha; }},
    {"C_m_q", "aero.pitch.q", -kAny, kAny, "pitch moment by pitch rate",
     [](const Airframe& a) { return a.pitch.q; }},
    {"C_m_delta_e", "aero.pitch.elevator", -kAny, kAny, "pitch moment by elevator",
     [](const Airframe& a) { return a.pitch.elevator; }},
};

/// The three lateral quantities, alike.
struct Lateral {
  const char* name;
  const char* key;
  const char* what;
  sim::LateralDerivatives Airframe::*part;
};
constexpr Lateral kLaterals[] = {{"C_Y_", "aero.side.", "side force", &Airframe::side},
                                 {"C_ell_", "aero.roll.", "roll moment", &Airframe::roll},
                                 {"C_n_", "aero.yaw.", "yaw moment", &Airframe::yaw}};
struct LateralEntry {
  const char* name;
  const char* key;
  const char* what;
  double sim::LateralDerivatives::*part;
};
constexpr LateralEntry kLateralEntries[] = {
    {"O", "zero", "", &sim::LateralDerivatives::zero},
    {"beta", "beta", " by sideslip", &sim::LateralDerivatives::beta},
    {"p", "p", " by roll rate", &sim::LateralDerivatives::p},
    {"r", "r", " by yaw rate", &sim::LateralDerivatives::r},
    {"delta_a", "aileron", " by aileron", &sim::LateralDerivatives::aileron},
    {"delta_r", "rudder", " by rudder", &sim::LateralDerivatives::rudder}};

Airframe airframe_of(const Vehicle& v) {
  return sim::read_fixed_wing(v.root()).airframe;
}

void add_airframe(List& list) {
  for (const Entry& e : kEntries) {
    add(list, e.name, e.min, e.max, e.what,
        [get = e.get](const Vehicle& v) { return get(airframe_of(v)); });
  }
  for (const Lateral& lateral : kLaterals) {
    for (const LateralEntry& e : kLateralEntries) {
      add(list, std::string(lateral.name) + e.name, -kAny, kAny, std::string(lateral.what) + e.what,
          [whole = lateral.part, part = e.part](const Vehicle& v) {
            return airframe_of(v).*whole.*part;
          });
    }
  }
}

std::vector<std::string> assign(const ViewValues& all, const Names& changed) {
  std::vector<std::string> out;
  const auto single = [&](const std::string& name, const std::string& key, double scale = 1.0) {
    if (changed.count(name) != 0) out.push_back(key + "=" + text(scale * all.at(name)[0]));
  };
  for (const Entry& e : kEntries) single(e.name, e.key, e.scale);
  for (const Lateral& lateral : kLaterals) {
    for (const LateralEntry& e : kLateralEntries) {
      single(std::string(lateral.name) + e.name, std::string(lateral.key) + e.key);
    }
  }
  single("servo_tau", "surfaces.time_constant_s");
  assign_propulsion(out, all, changed);
  return out;
}

}  // namespace

VehicleViews fixedwing_views() {
  VehicleViews views;
  add_airframe(views.list);
  add_propulsion(views.list);
  add_density(views.list);
  add(views.list, "servo_tau", 0.0, 1.0, "lag of the servos [s]",
      [](const Vehicle& v) { return sim::read_fixed_wing(v.root()).servo_time_constant_s; });
  views.assignments = assign;
  return views;
}

}  // namespace rosflight_sim
