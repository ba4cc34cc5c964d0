// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/mission_file.hpp"
#include "autonomy/fixedwing/planner.hpp"
#include "autonomy/fixedwing/types.hpp"
#include "base/constants.hpp"

namespace rosflight::autonomy::fixedwing {

/// Where a landing touches down, and its course.
struct LandingSite {
  Vector3 aim_W{Vector3::Zero()};    ///< Point of the ground; z against that of the start.
  std::optional<double> course_rad;  ///< Absent: that of the take-off, or against it, by the wind.
};

struct Mission {
  std::vector<Waypoint> waypoints;
  AtEnd at_end{AtEnd::kLand};
  std::optional<double> takeoff_height_m;  ///< Else the vehicle's.
  double score_radius_m{15.0};             ///< How near the truth must pass a waypoint.
  std::optional<double> radius_m;          ///< Radius of its turns; empty: that of the vehicle.
  LandingSite landing{};                   ///< Absent: the position of the start.
  std::optional<Fence> fence;              ///< Absent: none.
};

/// What a mission may ask of a vehicle.
struct MissionLimits {
  MissionArea area{.max_distance_m = 3000.0, .max_height_m = 150.0, .min_height_m = 15.0};
  PlannerConfig plan{};  ///< Radius, slopes and airspeed where the mission says none.
  double min_airspeed_m_s{13.0};
  double max_airspeed_m_s{22.0};
  double max_bank_rad{40.0 * kRadPerDeg};  ///< In still air, of any turn.
  double gravity_m_s2{base::kStandardGravity_m_s2};

  /// The plan's configuration for this mission.
  PlannerConfig plan_for(const Mission& mission) const;
};

/// Makes the last waypoint a circle for ever where at_end says that the flight stays there.
void close_mission(Mission& mission);

/// What cannot be flown, and where.
struct MissionFault {
  std::size_t waypoint{};  ///< Counted from 0.
  std::string key;         ///< Key in the mission file.
  std::string found;
  std::string allowed;
};
/// Plans the path of a list that is not empty: spacing, turns, slopes and banks.
std::optional<MissionFault> check_mission(const Mission& mission, const MissionLimits& limits);

/// Reads a mission file, the same format as for a multirotor (missions/README.md):
///
///     takeoff_height_m: 40         # optional
///     at_end: land                 # land (default), hold, cycle or return
///     path: fillet                 # line, fillet (default) or dubins: how waypoints are passed
///     radius_m: 60                 # of turns, at least the vehicle's
///     landing: {aim: [0, 0], heading_deg: 0}
///     mission:
///       - {type: goto, w: [400, -250, -70], speed: 17}
///       - {type: goto, w: [-400, -50, -70], path: dubins, heading_deg: 66}
///       - {type: hold, w: [0, 0, -60], hold_seconds: 30, turn: left}
///
/// The file of ROSflight 2.x (rosplane: w, lla, chi_d, use_chi, va_d under a repeated `wp`) is read
/// too: use_chi true is dubins with chi_d, false is fillet.
///
/// Before anything flies the path is planned: spacing below the turn radius, turns longer than
/// their legs or steeper than max_bank_rad, climbs too steep and circles that cannot be joined are
/// errors at the waypoint's line. After a fault nothing has been loaded.
/// Throws config::Error, one line: FILE:LINE: KEY: found X, allowed Y.
Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});
/// The same from memory; `name` stands for the file in messages.
Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin = {});

}  // namespace rosflight::autonomy::fixedwing
