// SPDX-License-Identifier: BSD-3-Clause
// Prints a vehicle file as a ROS parameter file under the names of ROSflight 2.x: what the simulator's nodes declare, with the
// values of the file as their defaults.
//
//     vehicle_parameters dynamics VEHICLE_FILE   sections of the forces and the dynamics node
//     vehicle_parameters sensors VEHICLE_FILE    section of the sensors node, with the errors of ROSflight 2.x's instruments
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "rosflight_sim/sensor_parameters.hpp"
#include "rosflight_sim/vehicle_views.hpp"
#include "sim/sensors/read_config.hpp"

namespace rosflight_sim {

namespace config = rosflight::config;
namespace sim = rosflight::sim;
namespace {

using Kind = VehicleView::Kind;

std::string number(double value, bool whole) {
  std::string text = config::number_text(value);
  if (whole || text.find('.') != std::string::npos) return text;
  return text.insert(std::min(text.find('e'), text.size()), ".0");  // a double for YAML
}

std::string text_of(Kind kind, const std::vector<double>& values) {
  if (kind == Kind::kSwitch) return values[0] != 0.0 ? "true" : "false";
  const bool whole = kind == Kind::kWholes;
  if (kind == Kind::kNumber || (whole && values.size() == 1)) return number(values[0], whole);
  std::string list;
  for (const double value : values) list += (list.empty() ? "" : ", ") + number(value, whole);
  return "[" + list + "]";
}

void begin(const std::string& node) {
  std::printf("/%s:\n  ros__parameters:\n", node.c_str());
}

void print(const sim::Vehicle& vehicle, const std::string& node, const VehicleViews& views) {
  begin(node);
  for (const VehicleView& view : views.list) {
    if (idle_in_rosflight_2(view.name)) continue;
    std::printf("    %s: %s  # %s\n", view.name.c_str(),
                text_of(view.kind, view.get(vehicle)).c_str(), view.text.c_str());
  }
}

void print_dynamics(const std::string& file) {
  const auto vehicle = sim::Vehicle::from_file(file);
  const bool fixed_wing = vehicle.type() == "fixedwing";
  print(vehicle, vehicle.type() + "_forces_and_moments",
        fixed_wing ? fixedwing_views() : multirotor_views());
  print(vehicle, "standalone_dynamics", dynamics_views());
}

void print_sensors(const std::string& file) {
  const auto vehicle = sim::Vehicle::from_file(file, {"sensors={preset: reference}"});
  SensorSettings settings{sim::sensors::read_sensors(vehicle.sensors()), vehicle.environment()};
  begin("standalone_sensors");
  for (const auto& parameter : sensor_parameters().parameters()) {
    const std::string unit =
        parameter.row.unit.empty() ? "" : " [" + std::string(parameter.row.unit) + "]";
    std::printf("    %s: %s  # %s%s\n", parameter.row.key.c_str(),
                number(parameter.get(settings)[0], false).c_str(),
                std::string(parameter.row.text).c_str(), unit.c_str());
  }
}

int run(const std::string& what, const std::string& file) {
  std::printf("# SPDX-License-Identifier: BSD-3-Clause\n# Made by vehicle_parameters from %s.\n",
              file.substr(file.rfind('/') + 1).c_str());
  what == "sensors" ? print_sensors(file) : print_dynamics(file);
  return 0;
}

}  // namespace
}  // namespace rosflight_sim

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (argc != 3 || (what != "dynamics" && what != "sensors")) {
    std::fprintf(stderr,
                 "vehicle_parameters: found %d words, allowed dynamics|sensors VEHICLE_FILE\n",
                 argc - 1);
    return 2;
  }
  try {
    return rosflight_sim::run(what, argv[2]);
  } catch (const std::exception& why) {
    std::fprintf(stderr, "vehicle_parameters: %s\n", why.what());
    return 2;
  }
}
