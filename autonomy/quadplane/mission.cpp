// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/mission.hpp"

#include "autonomy/quadplane/path.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

constexpr double kMaxSlope = 0.25;  // 4 m/s of climb at 17 m/s: more the pusher cannot

Mission read(const MissionFile& file, const MissionLimits& limits,
             const std::optional<Geodetic>& origin) {
  Mission mission;
  mission.takeoff_height_m = file.takeoff_height_m(limits.area).value_or(limits.takeoff_height_m);
  mission.score_radius_m = file.score_radius_m().value_or(mission.score_radius_m);
  mission.turn_radius_m = limits.turn_radius_m;
  mission.fence = file.fence();
  static_cast<void>(file.at_end({{"land", AtEnd::kLand}}));
  std::vector<Vector3> points{{0.0, 0.0, -mission.takeoff_height_m}};
  for (const config::Section& wp : file.waypoints) {
    if (waypoint_type(wp) != WaypointType::kGoto)
      throw wp.error("type", wp.raw("type"), "goto: a quad-plane holds at the end alone");
    points.push_back(waypoint_position(wp, limits.area, origin));
    check_fence(wp, mission.fence, points.back());
    wp.finish();
  }
  file.finish();
  mission.waypoints_W.assign(points.begin() + 1, points.end());
  Path path;
  if (const std::size_t leg = path.build(points, mission.turn_radius_m); leg > 0) {
    throw file.waypoints[leg - 1].error("w", file.waypoints[leg - 1].raw("w"),
                                        "a leg that is longer than its corners of " +
                                            config::number_text(mission.turn_radius_m) +
                                            " m radius");
  }
  for (std::size_t leg = 1; leg < points.size(); ++leg) {
    const double slope = path.steepest(leg);
    if (slope <= kMaxSlope) continue;
    throw file.waypoints[leg - 1].error(
        "w", config::number_text(slope) + " as the steepest slope of the leg, 1.5 times its mean",
        "at most " + config::number_text(kMaxSlope));
  }
  return mission;
}

}  // namespace

Mission read_mission(std::string_view text, const std::string& name, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  return read(MissionFile::read(text, name), limits, origin);
}

Mission load_mission(const std::filesystem::path& file, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  return read(MissionFile::load(file), limits, origin);
}

}  // namespace rosflight::autonomy::quadplane
