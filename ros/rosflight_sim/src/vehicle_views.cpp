// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/vehicle_views.hpp"

#include <cmath>
#include <utility>

#include "base/constants.hpp"
#include "rosflight_sim/view_tools.hpp"
#include "sim/environment/atmosphere.hpp"
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;
namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace views {

sim::MultirotorParameters rotors_of(const Vehicle& v) {
  return v.type() == "fixedwing" ? sim::read_fixed_wing(v.root()).propulsion
                                 : sim::read_multirotor(v.root());
}

void add_propulsion(List& list) {
  const char* thrust[] = {"CT_0", "CT_1", "CT_2"};
  const char* torque[] = {"CQ_0", "CQ_1", "CQ_2"};
  for (std::size_t i = 0; i < 3; ++i) {
    add(list, thrust[i], -1.0, 1.0, "thrust coefficient over the advance ratio",
        [i](const Vehicle& v) { return rotors_of(v).propeller.thrust[i]; });
    add(list, torque[i], -1.0, 1.0, "torque coefficient over the advance ratio",
        [i](const Vehicle& v) { return rotors_of(v).propeller.torque[i]; });
  }
  add(list, "D_prop", 0.001, 5.0, "diameter of a propeller [m]",
      [](const Vehicle& v) { return rotors_of(v).propeller.diameter_m; });
  add(list, "KQ", 1e-6, 10.0, "torque constant of a motor [N m/A]",
      [](const Vehicle& v) { return rotors_of(v).motor.torque_constant_Nm_A; });
  add(list, "R_motor", 1e-6, 100.0, "resistance of a motor [ohm]",
      [](const Vehicle& v) { return rotors_of(v).motor.resistance_ohm; });
  add(list, "I_0", 0.0, 100.0, "no-load current of a motor [A]",
      [](const Vehicle& v) { return rotors_of(v).motor.no_load_current_A; });
  add(list, "V_max", 0.1, 1000.0, "at full throttle; changed: a battery without end [V]",
      [](const Vehicle& v) {
        const sim::Battery battery{rotors_of(v).battery};
        return battery.open_circuit_V(battery.initial_charge_As());
      });
}

void add_density(List& list) {
  add(list, "rho", 0.01, 10.0, "density of the air; changed: the same everywhere [kg/m^3]",
      [](const Vehicle& v) {
        const auto& place = v.environment();
        return sim::Atmosphere{place.atmosphere}.at(place.origin.altitude_m).density_kg_m3;
      });
}

void assign_propulsion(std::vector<std::string>& out, const ViewValues& all, const Names& changed) {
  const auto number = [&all](const char* name) { return all.at(name)[0]; };
  const auto single = [&](const char* name, const char* key) {
    if (changed.count(name) != 0) out.push_back(std::string(key) + "=" + text(number(name)));
  };
  if (any(changed, {"CT_0", "CT_1", "CT_2"}))
    out.push_back("rotors.propeller.thrust_coefficients=" +
                  text(Numbers{number("CT_0"), number("CT_1"), number("CT_2")}));
  if (any(changed, {"CQ_0", "CQ_1", "CQ_2"}))
    out.push_back("rotors.propeller.torque_coefficients=" +
                  text(Numbers{number("CQ_0"), number("CQ_1"), number("CQ_2")}));
  single("D_prop", "rotors.propeller.diameter_m");
  single("KQ", "rotors.motor.torque_constant_Nm_A");
  single("R_motor", "rotors.motor.resistance_ohm");
  single("I_0", "rotors.motor.no_load_current_A");
  if (changed.count("V_max") != 0)
    out.push_back("battery={model: constant, constant_voltage_V: " + text(number("V_max")) + "}");
  if (changed.count("rho") != 0)
    out.push_back("environment.atmosphere={model: constant, density_kg_m3: " + text(number("rho")) +
                  "}");
}

}  // namespace views

using namespace views;

namespace {

using base::kDegPerRad;

Numbers numbers(const sim::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

// ---- body and wind ------------------------------------------------------------------------------

/// The wind of ROSflight 2.x's simulator: off, or drawn at the start, or as given; and gusts.
const sim::WindParameters& wind(const Vehicle& v) {
  return v.environment().wind;
}

bool blows(const Vehicle& v) {
  return !wind(v).steady_W_m_s.isZero() || !wind(v).random_std_W_m_s.isZero();
}

void add_inertia(List& list) {
  struct Element {
    const char* name;
    int row, column;
  };
  constexpr Element kElements[] = {{"Jxx", 0, 0}, {"Jyy", 1, 1}, {"Jzz", 2, 2},
                                   {"Jxy", 0, 1}, {"Jxz", 0, 2}, {"Jyz", 1, 2}};
  for (const Element& e : kElements)
    add(list, e.name, -1e4, 1e4, "element of the inertia matrix [kg m^2]",
        [e](const Vehicle& v) { return v.body().inertia_kg_m2(e.row, e.column); });
}

void add_wind(List& list) {
  add_list(list, "sim_has_wind", Kind::kSwitch, "a steady wind blows", true,
           [](const Vehicle& v) { return Numbers{blows(v) ? 1.0 : 0.0}; });
  add_list(list, "use_random_wind", Kind::kSwitch, "drawn at the start, not steady_state_wind",
           true, [](const Vehicle& v) {
             return Numbers{blows(v) && wind(v).random_std_W_m_s.isZero() ? 0.0 : 1.0};
           });
  const auto steady = [](const Vehicle& v) { return numbers(wind(v).steady_W_m_s); };
  add_list(list, "steady_state_wind", Kind::kNumbers, "north, east, down [m/s]", true, steady);
  add_list(list, "random_wind_mean", Kind::kNumbers, "north, east, down [m/s]", true, steady);
  add_list(list, "random_wind_std_dev", Kind::kNumbers, "north, east, down [m/s]", true,
           [](const Vehicle& v) {
             const auto& std = wind(v).random_std_W_m_s;
             return std.isZero() ? Numbers{0.5, 0.5, 0.0} : numbers(std);
           });
}

void add_gusts(List& list) {
  const auto gusts = [](double sim::GustParameters::*part) {
    return [part](const Vehicle& v) { return wind(v).gusts.*part; };
  };
  add_list(
      list, "wind_has_gusts", Kind::kSwitch, "gusts come at random", true,
      [](const Vehicle& v) { return Numbers{wind(v).gusts.mean_interval_s > 0.0 ? 1.0 : 0.0}; });
  add(list, "interoccurance_time_gust_s", 0.1, 1e6, "mean time between gusts [s]",
      [](const Vehicle& v) {
        constexpr double kUsual_s = 5.0;
        const double interval_s = wind(v).gusts.mean_interval_s;
        return interval_s > 0.0 ? interval_s : kUsual_s;
      });
  add(list, "gust_magnitude_mean", 0.0, 40.0, "[m/s]",
      gusts(&sim::GustParameters::magnitude_mean_m_s));
  add(list, "gust_magnitude_std_dev", 0.0, 20.0, "[m/s]",
      gusts(&sim::GustParameters::magnitude_std_m_s));
  add(list, "gust_dir_std_dev", 0.0, 100.0, "spread of the direction, per axis",
      gusts(&sim::GustParameters::direction_std));
  add_list(list, "gust_duration_limits", Kind::kNumbers, "shortest, longest [s]", true,
           [](const Vehicle& v) { return Numbers{wind(v).gusts.min_s, wind(v).gusts.max_s}; });
}

void assign_wind(std::vector<std::string>& out, const ViewValues& all) {
  const bool has_wind = all.at("sim_has_wind")[0] != 0.0;
  const bool random = all.at("use_random_wind")[0] != 0.0;
  const Numbers calm{0.0, 0.0, 0.0};
  out.push_back("environment.wind.steady_W_m_s=" + text(!has_wind ? calm
                                                        : random  ? all.at("random_wind_mean")
                                                                  : all.at("steady_state_wind")));
  out.push_back("environment.wind.random_std_W_m_s=" +
                text(has_wind && random ? all.at("random_wind_std_dev") : calm));
  if (all.at("wind_has_gusts")[0] == 0.0) return;
  const Numbers& limits = all.at("gust_duration_limits");
  if (limits.size() != 2)
    throw config::Error("gust_duration_limits: found " + text(limits) + ", allowed two numbers");
  out.push_back(
      "environment.wind.gusts={mean_interval_s: " + text(all.at("interoccurance_time_gust_s")[0]) +
      ", magnitude_mean_m_s: " + text(all.at("gust_magnitude_mean")[0]) +
      ", magnitude_std_m_s: " + text(all.at("gust_magnitude_std_dev")[0]) +
      ", direction_std: " + text(all.at("gust_dir_std_dev")[0]) + ", min_s: " + text(limits[0]) +
      ", max_s: " + text(limits[1]) + "}");
}

// ---- multirotor ---------------------------------------------------------------------------------

template <class Get>
Numbers for_each_rotor(const Vehicle& v, Get get) {
  Numbers out;
  for (const sim::RotorParameters& rotor : rotors_of(v).rotors) out.push_back(get(rotor));
  return out;
}

void add_rotors(List& list) {
  add_list(list, "num_rotors", Kind::kWholes, "number of rotors", false, [](const Vehicle& v) {
    return Numbers{static_cast<double>(rotors_of(v).rotors.size())};
  });
  add_list(list, "rotor_dists", Kind::kNumbers, "from the centre of mass [m]", false,
           [](const Vehicle& v) {
             return for_each_rotor(
                 v, [](const sim::RotorParameters& r) { return std::hypot(r.p_B.x(), r.p_B.y()); });
           });
  add_list(list, "rotor_radial_angles", Kind::kNumbers, "from the nose to the right [deg]", false,
           [](const Vehicle& v) {
             return for_each_rotor(v, [](const sim::RotorParameters& r) {
               const double angle = std::atan2(r.p_B.y(), r.p_B.x()) * kDegPerRad;
               return angle < 0.0 ? angle + 360.0 : angle;
             });
           });
  add_list(list, "rotor_rotation_directions", Kind::kWholes, "-1: its drag turns the nose right",
           false, [](const Vehicle& v) {
             return for_each_rotor(v, [](const sim::RotorParameters& r) { return r.spin; });
           });
}

constexpr double kArea_m2 = 0.04;  ///< A_c, when the vehicle file knows only the product C_D A.

void add_air(List& list) {
  add_density(list);
  add(list, "CD", 0.0, 1e4, "drag coefficient of the airframe",
      [](const Vehicle& v) { return rotors_of(v).aero.drag_area_m2.maxCoeff() / kArea_m2; });
  add(list, "A_c", 0.0, 1e4, "area of the airframe [m^2]",
      [](const Vehicle& /*v*/) { return kArea_m2; });
  add(list, "CD_induced", 0.0, 10.0, "drag of the rotors per thrust and speed [s/m]",
      [](const Vehicle& v) { return rotors_of(v).aero.rotor_drag_s_m; });
  add_list(list, "ground_effect", Kind::kNumbers, "quartic in height, highest power first", true,
           [](const Vehicle& v) {
             const auto& p = rotors_of(v).aero.ground_effect_polynomial;
             return Numbers(p.begin(), p.end());
           });
}

std::string layout(const ViewValues& all) {
  const auto count = static_cast<std::size_t>(all.at("num_rotors")[0]);
  const Numbers& dists = all.at("rotor_dists");
  const Numbers& angles = all.at("rotor_radial_angles");
  const Numbers& spins = all.at("rotor_rotation_directions");
  if (count < 1 || dists.size() != count || angles.size() != count || spins.size() != count) {
    throw config::Error("num_rotors: found " + text(all.at("num_rotors")[0]) +
                        ", allowed the length of rotor_dists, rotor_radial_angles and "
                        "rotor_rotation_directions");
  }
  std::string out = "rotors.layout=[";
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = angles[i] / kDegPerRad;
    const Numbers place{dists[i] * std::cos(angle), dists[i] * std::sin(angle), 0.0};
    out += std::string(i == 0 ? "" : ", ") + "{output: " + std::to_string(i) +
           ", position_m: " + text(place) +
           ", thrust_direction: [0, 0, -1], spin: " + text(spins[i]) + "}";
  }
  return out + "]";
}

std::vector<std::string> assign_multirotor(const ViewValues& all, const Names& changed) {
  std::vector<std::string> out;
  const auto number = [&all](const char* name) { return all.at(name)[0]; };
  const auto single = [&](const char* name, const char* key) {
    if (changed.count(name) != 0) out.push_back(std::string(key) + "=" + text(number(name)));
  };
  if (any(changed,
          {"num_rotors", "rotor_dists", "rotor_radial_angles", "rotor_rotation_directions"}))
    out.push_back(layout(all));
  assign_propulsion(out, all, changed);
  single("CD_induced", "aero.rotor_drag_s_m");
  if (any(changed, {"CD", "A_c"})) {
    const double area_m2 = number("CD") * number("A_c");
    out.push_back("aero.drag_area_m2=" + text(Numbers{area_m2, area_m2, area_m2}));
  }
  if (changed.count("ground_effect") != 0) {
    out.push_back("aero.ground_effect=polynomial");
    out.push_back("aero.ground_effect_polynomial=" + text(all.at("ground_effect")));
  }
  return out;
}

}  // namespace

VehicleViews dynamics_views() {
  VehicleViews views;
  add(views.list, "mass", 1e-3, 1e5, "[kg]", [](const Vehicle& v) { return v.body().mass_kg; });
  add(views.list, "gravity", 0.1, 100.0, "[m/s^2]",
      [](const Vehicle& v) { return v.environment().gravity_m_s2; });
  add_inertia(views.list);
  add_wind(views.list);
  add_gusts(views.list);
  views.assignments = [](const ViewValues& all, const Names& changed) {
    constexpr std::pair<const char*, const char*> kSingles[] = {
        {"mass", "body.mass_kg"},         {"gravity", "environment.gravity_m_s2"},
        {"Jxx", "body.inertia_kg_m2.xx"}, {"Jyy", "body.inertia_kg_m2.yy"},
        {"Jzz", "body.inertia_kg_m2.zz"}, {"Jxy", "body.inertia_kg_m2.xy"},
        {"Jxz", "body.inertia_kg_m2.xz"}, {"Jyz", "body.inertia_kg_m2.yz"}};
    std::vector<std::string> out;
    for (const auto& [name, key] : kSingles)
      if (changed.count(name) != 0) out.push_back(std::string(key) + "=" + text(all.at(name)[0]));
    for (const std::string& name : changed) {
      if (name.find("wind") == std::string::npos && name.find("gust") == std::string::npos)
        continue;
      assign_wind(out, all);
      break;
    }
    return out;
  };
  return views;
}

VehicleViews multirotor_views() {
  VehicleViews views;
  add_rotors(views.list);
  add_propulsion(views.list);
  add_air(views.list);
  views.assignments = assign_multirotor;
  return views;
}

}  // namespace rosflight_sim
