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

namespace {

const KeyViews& propulsion() {
  static const KeyViews views{{"CT_0", "rotors.propeller.thrust_coefficients", 0},
                              {"CT_1", "rotors.propeller.thrust_coefficients", 1},
                              {"CT_2", "rotors.propeller.thrust_coefficients", 2},
                              {"CQ_0", "rotors.propeller.torque_coefficients", 0},
                              {"CQ_1", "rotors.propeller.torque_coefficients", 1},
                              {"CQ_2", "rotors.propeller.torque_coefficients", 2},
                              {"D_prop", "rotors.propeller.diameter_m"},
                              {"KQ", "rotors.motor.torque_constant_Nm_A"},
                              {"R_motor", "rotors.motor.resistance_ohm"},
                              {"I_0", "rotors.motor.no_load_current_A"}};
  return views;
}

}  // namespace

void add_propulsion(List& list) {
  add(list, propulsion());
  add(list, "V_max", 0.1, 1000.0,
      "voltage at full throttle; a change makes the battery constant [V]", [](const Vehicle& v) {
        const sim::Battery battery{rotors_of(v).battery};
        return battery.open_circuit_V(battery.initial_charge_As());
      });
}

void add_density(List& list) {
  add(list, "rho", 0.01, 10.0, "density of the air; a change makes it the same everywhere [kg/m^3]",
      [](const Vehicle& v) {
        const auto& place = v.environment();
        return sim::Atmosphere{place.atmosphere}.at(place.origin.altitude_m).density_kg_m3;
      });
}

void assign_propulsion(std::vector<std::string>& out, const ViewValues& all, const Names& changed) {
  const auto number = [&all](const char* name) { return all.at(name)[0]; };
  assign(out, propulsion(), all, changed);
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

const KeyViews& body() {
  static const KeyViews views{
      {"mass", "body.mass_kg"},         {"gravity", "environment.gravity_m_s2"},
      {"Jxx", "body.inertia_kg_m2.xx"}, {"Jyy", "body.inertia_kg_m2.yy"},
      {"Jzz", "body.inertia_kg_m2.zz"}, {"Jxy", "body.inertia_kg_m2.xy"},
      {"Jxz", "body.inertia_kg_m2.xz"}, {"Jyz", "body.inertia_kg_m2.yz"}};
  return views;
}

void add_wind(List& list) {
  add_list(list, "sim_has_wind", Kind::kSwitch, "a steady wind blows", true,
           [](const Vehicle& v) { return Numbers{blows(v) ? 1.0 : 0.0}; });
  add_list(list, "use_random_wind", Kind::kSwitch,
           "draws the wind at the start instead of steady_state_wind", true, [](const Vehicle& v) {
             return Numbers{blows(v) && wind(v).random_std_W_m_s.isZero() ? 0.0 : 1.0};
           });
  const auto steady = [](const Vehicle& v) { return numbers(wind(v).steady_W_m_s); };
  add_list(list, "steady_state_wind", Kind::kNumbers, "steady wind north, east, down [m/s]", true,
           steady);
  add_list(list, "random_wind_mean", Kind::kNumbers,
           "mean of the random wind north, east, down [m/s]", true, steady);
  add_list(list, "random_wind_std_dev", Kind::kNumbers,
           "deviation of the random wind north, east, down [m/s]", true, [](const Vehicle& v) {
             const auto& std = wind(v).random_std_W_m_s;
             return std.isZero() ? Numbers{0.5, 0.5, 0.0} : numbers(std);
           });
}

void add_gusts(List& list) {
  add_list(
      list, "wind_has_gusts", Kind::kSwitch, "gusts come at random", true,
      [](const Vehicle& v) { return Numbers{wind(v).gusts.mean_interval_s > 0.0 ? 1.0 : 0.0}; });
  const auto interval_s = [](const Vehicle& v) {
    constexpr double kUsual_s = 5.0;
    const double from_file_s = wind(v).gusts.mean_interval_s;
    return from_file_s > 0.0 ? from_file_s : kUsual_s;
  };
  add(list, {"interoccurance_time_gust_s", "environment.wind.gusts.mean_interval_s"}, interval_s);
  add(list, {{"gust_magnitude_mean", "environment.wind.gusts.magnitude_mean_m_s"},
             {"gust_magnitude_std_dev", "environment.wind.gusts.magnitude_std_m_s"},
             {"gust_dir_std_dev", "environment.wind.gusts.direction_std"}});
  add_list(list, "gust_duration_limits", Kind::kNumbers,
           "minimum and maximum duration of a gust [s]", true,
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
  add_list(list, "rotor_dists", Kind::kNumbers,
           "distances of the rotors from the centre of mass [m]", false, [](const Vehicle& v) {
             return for_each_rotor(
                 v, [](const sim::RotorParameters& r) { return std::hypot(r.p_B.x(), r.p_B.y()); });
           });
  add_list(list, "rotor_radial_angles", Kind::kNumbers,
           "angles of the rotors from the nose to the right [deg]", false, [](const Vehicle& v) {
             return for_each_rotor(v, [](const sim::RotorParameters& r) {
               const double angle = std::atan2(r.p_B.y(), r.p_B.x()) * kDegPerRad;
               return angle < 0.0 ? angle + 360.0 : angle;
             });
           });
  add_list(list, "rotor_rotation_directions", Kind::kWholes,
           "rotation of each rotor; -1: its drag turns the nose right", false,
           [](const Vehicle& v) {
             return for_each_rotor(v, [](const sim::RotorParameters& r) { return r.spin; });
           });
}

const KeyViews kInducedDrag{{"CD_induced", "aero.rotor_drag_s_m"}};
constexpr double kArea_m2 = 0.04;  ///< A_c, when the vehicle file knows only the product C_D A.

void add_air(List& list) {
  add_density(list);
  add(list, "CD", 0.0, 1e4, "drag coefficient of the airframe",
      [](const Vehicle& v) { return rotors_of(v).aero.drag_area_m2.maxCoeff() / kArea_m2; });
  add(list, "A_c", 0.0, 1e4, "area of the airframe [m^2]",
      [](const Vehicle& /*v*/) { return kArea_m2; });
  add(list, kInducedDrag);
  add_list(list, "ground_effect", Kind::kNumbers,
           "quartic of the ground effect in height, highest power first", true,
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
    const Numbers position{dists[i] * std::cos(angle), dists[i] * std::sin(angle), 0.0};
    out += std::string(i == 0 ? "" : ", ") + "{output: " + std::to_string(i) +
           ", position_m: " + text(position) +
           ", thrust_direction: [0, 0, -1], spin: " + text(spins[i]) + "}";
  }
  return out + "]";
}

std::vector<std::string> assign_multirotor(const ViewValues& all, const Names& changed) {
  std::vector<std::string> out;
  const auto number = [&all](const char* name) { return all.at(name)[0]; };
  if (any(changed,
          {"num_rotors", "rotor_dists", "rotor_radial_angles", "rotor_rotation_directions"}))
    out.push_back(layout(all));
  assign_propulsion(out, all, changed);
  assign(out, kInducedDrag, all, changed);
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
  add(views.list, body());
  add_wind(views.list);
  add_gusts(views.list);
  views.assignments = [](const ViewValues& all, const Names& changed) {
    std::vector<std::string> out;
    assign(out, body(), all, changed);
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
