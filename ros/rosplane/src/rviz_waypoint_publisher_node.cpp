// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/waypoint_markers.hpp"

#include <rosplane_msgs/msg/waypoint.hpp>

#include "rosflight_common/component.hpp"

namespace rosplane {
namespace {

struct MarkerPolicy {
  using Waypoint = rosplane_msgs::msg::Waypoint;
  static constexpr const char* kTopic = "waypoint_path";
  static constexpr double kSphere_m = 5.0;  // sizes of rosplane 2.0
  static constexpr double kText_m = 15.0;
  static bool geodetic(const Waypoint& waypoint) { return waypoint.lla; }
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosflight_common::WaypointMarkers<rosplane::MarkerPolicy>, SingleThreadedExecutor)
