// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/common/geodesy.hpp"
#include "autonomy/common/types.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::autonomy {

enum class AtEnd : std::uint8_t {
  kLand,   ///< Multirotor: below the last waypoint. Fixed wing: at the section `landing`.
  kHold,   ///< Stay at the last waypoint; a fixed wing circles it.
  kCycle,  ///< Fly to the first again.
  kReturn  ///< Fixed wing: circle the position of the start.
};

/// The space a mission may use.
struct MissionArea {
  double max_distance_m{2000.0};  ///< Horizontally from the origin.
  double max_height_m{120.0};     ///< Above the origin.
  double min_height_m{0.5};
};

inline constexpr std::size_t kMaxWaypoints = 1000;

/// A mission file as far as all vehicles read it alike. The vehicle's reader takes the rest of each
/// waypoint, then finishes every section. missions/README.md lists the keys.
///
/// Two forms are read: a map with the key `mission`, a list of waypoints; and the file of ROSflight
/// 2.x, a map that repeats the key `wp` (no valid YAML), where it is the first key.
struct MissionFile {
  std::vector<config::Section> waypoints;  ///< 1 to kMaxWaypoints.
  std::optional<config::Section> root;     ///< Absent in the form of ROSflight 2.x.

  /// Throws config::Error, one line: FILE:LINE: KEY: found X, allowed Y.
  static MissionFile load(const std::filesystem::path& file);
  /// The same from memory; `name` stands for the file in messages.
  static MissionFile read(std::string_view text, const std::string& name);

  /// Above the start [m]; absent if the file has none. Throws config::Error outside the area.
  std::optional<double> takeoff_height_m(const MissionArea& area) const;
  /// Key `score_radius_m`: how near a waypoint must be passed, by the truth; absent if the file has
  /// none. Guidance does not use it.
  std::optional<double> score_radius_m() const;
  /// Key `at_end`; the first of `choices` if the file has none.
  AtEnd at_end(const config::Section::Choices<AtEnd>& choices) const;
  /// Key `fence`: radius_m and height_m, both from the start; absent if the file has none.
  std::optional<Fence> fence() const;
  /// Unknown keys of the head are errors.
  void finish() const;
};

/// Key `type`: goto or hold, or ROSflight's numbers 1 and 0.
WaypointType waypoint_type(const config::Section& wp);
/// Key `w`, north, east, down [m], or with `use_lla` (also `lla`) latitude, longitude [deg] and
/// altitude [m]; inside `area`, in local coordinates.
Vector3 waypoint_position(const config::Section& wp, const MissionArea& area,
                          const std::optional<Geodetic>& origin);
/// What is wrong with a position from the start, for a message.
struct OutsideOfFence {
  std::string found;
  std::string allowed;
};
/// Absent if the fence holds the position, or if there is none.
std::optional<OutsideOfFence> outside_of(const std::optional<Fence>& fence, const Vector3& p_W);
/// Throws config::Error for a waypoint outside of the fence.
void check_fence(const config::Section& wp, const std::optional<Fence>& fence, const Vector3& p_W);
/// One of the keys heading_deg and `radians`; absent if neither is there.
std::optional<double> waypoint_heading_rad(const config::Section& wp, std::string_view radians);

struct HoldTime {
  double hold_s{};
  bool indefinitely{};
};
/// Keys hold_seconds and hold_indefinitely; a goto may carry 0 and false.
HoldTime waypoint_hold(const config::Section& wp, WaypointType type);

}  // namespace rosflight::autonomy
