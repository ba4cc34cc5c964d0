// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

#include "rosflight_common/given_values.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/vehicle_file.hpp"
#include "rosflight_sim/parameter_file.hpp"
#include "sim/random.hpp"
#include "sim/vehicle.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// The vehicle of a node, from its parameters `vehicle_file`, `vehicle_overrides` and `seed`.
struct VehicleParameters {
  sim::Vehicle vehicle;
  sim::RandomSource random;
  std::string file;
  std::vector<std::string> overrides;
  /// Where `vehicle_file` names a ROS parameter file: its values go on top of a vehicle of its type.
  std::shared_ptr<ParameterFile> given;

  /// The vehicle again, with these on top of what was given. @throws config::Error, nothing changed.
  void make(const std::vector<std::string>& assignments) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), assignments.begin(), assignments.end());
    vehicle = sim::Vehicle::from_file(file, all);
  }

  /// Values of a ROS parameter file for a node.
  rosflight_common::GivenValues values_for(const std::string& node) const {
    if (!given) return {};
    return [file = given, node](const std::string& name, rosflight_common::GivenKind kind) {
      return file->value(node, name, kind);
    };
  }

  /// Logs what a ROS parameter file has for the node and nobody reads. Call it when all parameters are declared.
  void log_unused(const rclcpp::Node& node) const {
    if (!given) return;
    std::string names;
    for (const std::string& name : given->unused(node.get_name()))
      names += (names.empty() ? "; without effect: " : ", ") + name;
    RCLCPP_INFO(node.get_logger(), "vehicle_file is a ROS parameter file, on top of %s%s",
                file.c_str(), names.c_str());
  }

  /// @throws config::Error  one line: no such file, unknown key, value out of range.
  static VehicleParameters declare(rclcpp::Node& node) {
    auto named = rosflight_common::VehicleFile::declare(
        node, usual_vehicle(node.get_name()), ", or -r __node:=multirotor_forces_and_moments");
    const std::int64_t seed =
        rosflight_common::declare_integer(node, "seed", 1, 0, 1'000'000'000'000,
                                          "seed of all random numbers: errors of sensors, wind");
    std::shared_ptr<ParameterFile> given;
    if (auto read = ParameterFile::load(named.file)) {
      given = std::make_shared<ParameterFile>(std::move(*read));
      named.file = rosflight_common::VehicleFile::of_simulator(usual_vehicle(given->type()));
    }
    return {named.read(), sim::RandomSource{static_cast<std::uint64_t>(seed)}, named.file,
            named.overrides, given};
  }

 private:
  /// By what the name of a node or of a type of vehicle says. The forces node by its own name can be of both types.
  static std::string usual_vehicle(const std::string& name) {
    if (name.find("fixedwing") != std::string::npos) return "anaconda";
    return name == "mav_forces_and_moments" ? "" : "multirotor";
  }
};

}  // namespace rosflight_sim
