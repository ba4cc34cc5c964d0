// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "ros/rosflight_sim/src/node_tools.hpp"
#include "sim/random.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::ros_sim {

/// The vehicle of a node, from its parameters `vehicle_file`, `vehicle_overrides` and `seed`.
struct VehicleParameters {
  sim::Vehicle vehicle;
  sim::RandomSource random;
  std::string file;
  std::vector<std::string> overrides;

  /// The vehicle anew, with these on top of what was given. @throws config::Error, nothing changed.
  void make(const std::vector<std::string>& assignments) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), assignments.begin(), assignments.end());
    vehicle = sim::Vehicle::from_file(file, all);
  }

  /// @throws config::Error  one line: no such file, unknown key, value out of range.
  static VehicleParameters declare(rclcpp::Node& node) {
    const std::string file =
        declare_text(node, "vehicle_file", "", "vehicle file (YAML), see vehicles/README.md");
    if (file.empty()) {
      throw config::Error("parameter vehicle_file: found nothing, allowed a vehicle file");
    }
    const auto overrides = node.declare_parameter<std::vector<std::string>>(
        "vehicle_overrides", {}, described("section.key=value, instead of what the file says"));
    std::vector<std::string> given;
    for (const auto& text : overrides)
      if (!text.empty()) given.push_back(text);
    const std::int64_t seed = declare_whole(node, "seed", 1, 0, 1'000'000'000'000,
                                            "of all random numbers: errors of sensors, wind");
    return {sim::Vehicle::from_file(file, given),
            sim::RandomSource{static_cast<std::uint64_t>(seed)}, file, given};
  }
};

}  // namespace rosflight::ros_sim
