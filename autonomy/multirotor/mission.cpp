// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/mission.hpp"

#include <string>

namespace rosflight::autonomy::multirotor {
namespace {

using config::Range;
using config::Section;

constexpr double kMinLegSpeed_m_s = 0.1;

void reject_fixedwing_keys(const Section& in, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (in.has(key)) throw in.error(key, in.raw(key), "nothing: it is for a fixed wing");
  }
}

Waypoint waypoint_of(const Section& wp, const MissionLimits& limits,
                     const std::optional<Geodetic>& origin) {
  reject_fixedwing_keys(wp, {"path", "turn", "chi_d", "use_chi", "va_d"});
  Waypoint out;
  out.type = waypoint_type(wp);
  out.p_W = waypoint_position(wp, limits.area(), origin);
  const auto psi_rad = waypoint_heading_rad(wp, "psi");
  out.psi_rad = psi_rad ? *psi_rad : wp.number("psi", Range::any());
  out.speed_m_s = wp.number("speed", Range::between(kMinLegSpeed_m_s, limits.max_speed_m_s),
                            limits.max_speed_m_s);
  const HoldTime hold = waypoint_hold(wp, out.type);
  out.hold_s = hold.hold_s;
  out.hold_indefinitely = hold.indefinitely;
  return out;
}

/// Behind its crossing, a waypoint like any other.
Waypoint figure_of(const Section& in, const Waypoint& crossing, const MissionLimits& limits) {
  constexpr double kLobeLength = 2.8322;  // in radii
  if (crossing.hold_indefinitely)
    throw in.error("a figure behind a hold for ever", "a hold that ends");
  Waypoint out = crossing;
  out.type = WaypointType::kGoto;
  out.hold_s = 0.0;
  out.figure_turns = static_cast<int>(in.integer("turns", 1, 100, 1));
  out.speed_m_s = in.number("speed", Range::between(kMinLegSpeed_m_s, limits.max_speed_m_s),
                            limits.max_speed_m_s);
  out.figure_radius_m = in.number("radius_m", Range::between(0.5, 1000.0));
  out.figure_course_rad = in.number("course_deg", Range::between(-360.0, 360.0), 0.0) * kRadPerDeg;
  const double farthest_m = crossing.p_W.head<2>().norm() + kLobeLength * out.figure_radius_m;
  if (farthest_m > limits.max_distance_m) {
    throw in.error("radius_m", in.raw("radius_m"),
                   "a figure within " + config::number_text(limits.max_distance_m) + " m");
  }
  return out;
}

Mission read(const MissionFile& file, const MissionLimits& limits,
             const std::optional<Geodetic>& origin) {
  Mission mission;
  mission.takeoff_height_m = file.takeoff_height_m(limits.area());
  mission.score_radius_m = file.score_radius_m().value_or(mission.score_radius_m);
  mission.fence = file.fence();
  mission.at_end =
      file.at_end({{"land", AtEnd::kLand}, {"hold", AtEnd::kHold}, {"cycle", AtEnd::kCycle}});
  if (file.root) reject_fixedwing_keys(*file.root, {"landing"});
  mission.waypoints.reserve(2 * file.waypoints.size());
  for (const Section& wp : file.waypoints) {
    if (!mission.waypoints.empty() && mission.waypoints.back().hold_indefinitely) {
      throw wp.error("a waypoint behind one that holds for ever",
                     "hold_indefinitely at the last waypoint only");
    }
    mission.waypoints.push_back(waypoint_of(wp, limits, origin));
    check_fence(wp, mission.fence, mission.waypoints.back().p_W);
    if (const auto figure = wp.optional_section("figure_eight")) {
      mission.waypoints.push_back(figure_of(*figure, mission.waypoints.back(), limits));
    }
    wp.finish();
  }
  file.finish();
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

}  // namespace rosflight::autonomy::multirotor
