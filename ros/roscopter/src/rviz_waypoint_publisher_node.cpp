// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/waypoint_markers.hpp"

#include <roscopter_msgs/msg/waypoint.hpp>

#include "rosflight_common/component.hpp"

namespace roscopter {
namespace {

struct MarkerPolicy {
  using Waypoint = roscopter_msgs::msg::Waypoint;
  static constexpr const char* kTopic = "waypoints";
  static constexpr double kSphere_m = 1.5;  // sizes of roscopter 2.0
  static constexpr double kText_m = 5.0;
  static bool geodetic(const Waypoint& waypoint) { return waypoint.use_lla; }
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(rosflight_common::WaypointMarkers<roscopter::MarkerPolicy>, SingleThreadedExecutor)
