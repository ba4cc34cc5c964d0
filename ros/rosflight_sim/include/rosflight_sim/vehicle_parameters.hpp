// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/vehicle_file.hpp"
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

  /// The vehicle again, with these on top of what was given. @throws config::Error, nothing changed.
  void make(const std::vector<std::string>& assignments) {
    std::vector<std::string> all = overrides;
    all.insert(all.end(), assignments.begin(), assignments.end());
    vehicle = sim::Vehicle::from_file(file, all);
  }

  /// @throws config::Error  one line: no such file, unknown key, value out of range.
  static VehicleParameters declare(rclcpp::Node& node) {
    const auto given = rosflight_common::VehicleFile::declare(node);
    const std::int64_t seed = rosflight_common::declare_whole(
        node, "seed", 1, 0, 1'000'000'000'000, "of all random numbers: errors of sensors, wind");
    return {given.read(), sim::RandomSource{static_cast<std::uint64_t>(seed)}, given.file,
            given.overrides};
  }
};

}  // namespace rosflight_sim
