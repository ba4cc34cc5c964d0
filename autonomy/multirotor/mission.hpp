// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/mission_file.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

struct Mission {
  std::vector<Waypoint> waypoints;
  AtEnd at_end{AtEnd::kLand};
  std::optional<double> takeoff_height_m;  ///< Else the vehicle's.
  double score_radius_m{2.0};              ///< How near the truth must pass a waypoint.
  std::optional<Fence> fence;              ///< Absent: none.
};

/// What a mission may ask of a vehicle.
struct MissionLimits {
  double max_distance_m{2000.0};  ///< Horizontally from the origin.
  double max_height_m{120.0};     ///< Above the origin.
  double min_height_m{0.5};
  double max_speed_m_s{5.0};

  MissionArea area() const { return {max_distance_m, max_height_m, min_height_m}; }
};

/// Reads a mission file.
///
///     takeoff_height_m: 2.0        # optional
///     at_end: land                 # land (default), hold or cycle
///     mission:
///       - {type: goto, w: [10, 0, -4], speed: 4, psi: 1.57}
///       - {type: hold, w: [10, 5, -4], heading_deg: 90, hold_seconds: 3}
///
/// Keys of a waypoint: type (goto, hold, or ROSflight's numbers 1, 0), w (north, east, down [m];
/// with use_lla: true latitude, longitude [deg], altitude [m]), psi [rad] or heading_deg, speed
/// [m/s] (default: the vehicle's limit), hold_seconds or hold_indefinitely (type hold only; a goto
/// may carry 0 and false). The file of ROSflight 2.x, a map that repeats the key `wp`, is read too;
/// it is no valid YAML.
///
/// Everything is checked against `limits`; after a fault nothing has been loaded.
/// @param origin  of the local frame; needed for geodetic waypoints only.
/// Throws config::Error, one line: FILE:LINE: KEY: found X, allowed Y.
Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});
/// The same from memory; `name` stands for the file in messages.
Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});

}  // namespace rosflight::autonomy::multirotor
