// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "sim/vehicle.hpp"

namespace rosflight_common {

namespace config = rosflight::config;
namespace sim = rosflight::sim;

/// The vehicle of a node, from its parameters `vehicle_file` and `vehicle_overrides`.
struct VehicleFile {
  std::string file;
  std::vector<std::string> overrides;

  sim::Vehicle read() const { return sim::Vehicle::from_file(file, overrides); }

  /// @throws config::Error  one line, if no file is named.
  static VehicleFile declare(rclcpp::Node& node) {
    VehicleFile out;
    out.file =
        declare_text(node, "vehicle_file", "", "vehicle file (YAML), see vehicles/README.md");
    if (out.file.empty()) {
      throw config::Error("parameter vehicle_file: found nothing, allowed a vehicle file");
    }
    const auto given = node.declare_parameter<std::vector<std::string>>(
        "vehicle_overrides", {}, described("section.key=value, instead of what the file says"));
    for (const auto& text : given) {
      if (!text.empty()) out.overrides.push_back(text);
    }
    return out;
  }
};

}  // namespace rosflight_common
