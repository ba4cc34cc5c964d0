// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "autonomy/fixedwing/mission.hpp"
#include "autonomy/fixedwing/path_manager.hpp"
#include "config/strict_yaml.hpp"

namespace {

using namespace rosflight;  // NOLINT(google-build-using-namespace): a program of one file
using autonomy::fixedwing::Mission;
using autonomy::fixedwing::MissionLimits;
using autonomy::fixedwing::Plan;
using autonomy::fixedwing::Segment;

void need(bool holds) {
  if (!holds) std::abort();
}

void check_waypoints(const Mission& mission, const MissionLimits& limits) {
  need(!mission.waypoints.empty() && mission.waypoints.size() <= autonomy::kMaxWaypoints);
  for (const auto& wp : mission.waypoints) {
    need(std::hypot(wp.p_W.x(), wp.p_W.y()) <= limits.area.max_distance_m);
    need(-wp.p_W.z() >= limits.area.min_height_m && -wp.p_W.z() <= limits.area.max_height_m);
    need(wp.airspeed_m_s == 0.0 || (wp.airspeed_m_s >= limits.min_airspeed_m_s &&
                                    wp.airspeed_m_s <= limits.max_airspeed_m_s));
    need(wp.hold_s >= 0.0 && std::isfinite(wp.hold_s) && std::isfinite(wp.course_rad));
  }
}

/// A mission that loads has a path without steps, with slopes the vehicle flies.
void check_plan(const Mission& mission, const MissionLimits& limits) {
  constexpr double kStep_m = 1e-3;
  const autonomy::fixedwing::PlannerConfig config = limits.plan_for(mission);
  const bool cycle = mission.at_end == autonomy::AtEnd::kCycle;
  Plan plan;
  need(!autonomy::fixedwing::Planner(config).plan({}, mission.waypoints, cycle, 0, plan));
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    const Segment& segment = plan.segments[k];
    need(segment.length_m > 0.0 && std::isfinite(segment.height0_m + segment.height1_m));
    need(std::abs(segment.slope()) <= std::max(config.climb_slope, config.descent_slope) + 1e-6);
    if (k + 1 == plan.segments.size() || !std::isfinite(segment.length_m)) continue;
    const auto end_m = segment.point_at(segment.length_m);
    need((end_m - plan.segments[k + 1].start.p_m).norm() < kStep_m);
    need(std::abs(segment.height1_m - plan.segments[k + 1].height0_m) < kStep_m);
  }
}

}  // namespace

/// Any bytes as a mission file of a fixed wing: refused with one line, or a mission within the
/// limits whose path can be flown.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const MissionLimits limits;
  try {
    const Mission mission = autonomy::fixedwing::read_mission(
        text, "fuzz", limits, autonomy::Geodetic{40.0, -111.0, 1400.0});
    check_waypoints(mission, limits);
    check_plan(mission, limits);
  } catch (const config::Error& error) {
    need(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
