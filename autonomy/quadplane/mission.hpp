// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/quadplane/config.hpp"

namespace rosflight::autonomy::quadplane {

/// A route: up at the start, forward over the waypoints with rounded corners, down below the last one.
struct Mission {
  std::vector<Vector3> waypoints_W;
  double takeoff_height_m{30.0};
  double turn_radius_m{100.0};
  double score_radius_m{5.0};  ///< How near the truth must pass a waypoint.
  std::optional<Fence> fence;
};

/// Reads a mission file (missions/README.md). Waypoints are of the type `goto` without heading or speed.
/// Throws config::Error, one line, also for a leg that is too short for its corners, or too steep.
Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});
/// The same from memory; `name` stands for the file in messages.
Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});

}  // namespace rosflight::autonomy::quadplane
