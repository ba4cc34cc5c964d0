// SPDX-License-Identifier: BSD-3-Clause
// Parameters of ROSflight 2.x's fixed-wing forces node. Those that its equations never used
// (wing_epsilon apart, which is the Oswald factor here) are not there.

#include "base/constants.hpp"
#include "rosflight_sim/view_tools.hpp"

namespace rosflight_sim {

using namespace views;

namespace {

KeyViews airframe() {
  KeyViews views{{"wing_s", "aero.wing.area_m2"},
                 {"wing_b", "aero.wing.span_m"},
                 {"wing_c", "aero.wing.chord_m"},
                 {"wing_epsilon", "aero.wing.oswald"},
                 {"wing_M", "aero.stall.sharpness_1_rad"},
                 {"wing_alpha0", "aero.stall.angle_deg", 0, rosflight::base::kDegPerRad},
                 {"C_L_O", "aero.lift.zero"},
                 {"C_L_alpha", "aero.lift.alpha"},
                 {"C_L_q", "aero.lift.q"},
                 {"C_L_delta_e", "aero.lift.elevator"},
                 {"C_D_p", "aero.drag.parasitic"},
                 {"C_D_q", "aero.drag.q"},
                 {"C_D_delta_e", "aero.drag.elevator"},
                 {"C_m_O", "aero.pitch.zero"},
                 {"C_m_alpha", "aero.pitch.alpha"},
                 {"C_m_q", "aero.pitch.q"},
                 {"C_m_delta_e", "aero.pitch.elevator"},
                 {"servo_tau", "surfaces.time_constant_s"}};
  constexpr std::pair<const char*, const char*> kLaterals[] = {
      {"C_Y_", "aero.side."}, {"C_ell_", "aero.roll."}, {"C_n_", "aero.yaw."}};
  constexpr std::pair<const char*, const char*> kDerivatives[] = {
      {"O", "zero"}, {"beta", "beta"},       {"p", "p"},
      {"r", "r"},    {"delta_a", "aileron"}, {"delta_r", "rudder"}};
  for (const auto& [prefix, section] : kLaterals)
    for (const auto& [name, key] : kDerivatives)
      views.push_back({std::string(prefix) + name, std::string(section) + key});
  return views;
}

}  // namespace

VehicleViews fixedwing_views() {
  VehicleViews views;
  add(views.list, airframe());
  add_propulsion(views.list);
  add_density(views.list);
  views.assignments = [](const ViewValues& all, const Names& changed) {
    std::vector<std::string> out;
    assign(out, airframe(), all, changed);
    assign_propulsion(out, all, changed);
    return out;
  };
  return views;
}

}  // namespace rosflight_sim
