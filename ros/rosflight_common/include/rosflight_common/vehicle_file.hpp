// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/paths.hpp"
#include "sim/vehicle.hpp"

namespace rosflight_common {

namespace config = rosflight::config;
namespace sim = rosflight::sim;

/// The vehicle of a node, from its parameters `vehicle_file` and `vehicle_overrides`.
struct VehicleFile {
  std::string file;
  std::vector<std::string> overrides;

  /// A vehicle of rosflight_sim by its name. Empty: it is not installed.
  static std::string of_simulator(const std::string& vehicle) {
    return installed("share/rosflight_sim/vehicles/" + vehicle + ".yaml").value_or("");
  }

  sim::Vehicle read() const { return sim::Vehicle::from_file(file, overrides); }

  /// @param usual  vehicle of rosflight_sim to take if no file is named, as the launch files do; empty: none.
  /// @param or_type  what else the user may type, for the message.
  /// @throws config::Error  one line, if there is none to take.
  static VehicleFile declare(rclcpp::Node& node, const std::string& usual,
                             const std::string& or_type = "") {
    VehicleFile out;
    out.file =
        declare_text(node, "vehicle_file", "", "vehicle file (YAML), see vehicles/README.md");
    if (out.file.empty() && !usual.empty()) {
      out.file = of_simulator(usual);
      RCLCPP_WARN(node.get_logger(), "no vehicle_file given: %s", out.file.c_str());
    }
    if (out.file.empty()) {
      throw config::Error(
          "parameter vehicle_file: found nothing, allowed a vehicle file: -p vehicle_file:=FILE" +
          or_type);
    }
    const auto given = node.declare_parameter<std::vector<std::string>>(
        "vehicle_overrides", {},
        described("values that replace those of the vehicle file: section.key=value"));
    for (const auto& text : given) {
      if (!text.empty()) out.overrides.push_back(text);
    }
    return out;
  }
};

}  // namespace rosflight_common
