// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <geometry_msgs/msg/point.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>
#include <visualization_msgs/msg/marker.hpp>

#include "autonomy/common/mission_file.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/node_tools.hpp"

namespace rosflight_common {

/// Node rviz_waypoint_publisher of both stacks: the waypoints in force for RViz on `rviz/waypoint`: spheres, the path between
/// them and their numbers, in frame NED.
///
/// Policy: `Waypoint`, the message; kTopic, where it comes from; kSphere_m and kText_m, default sizes; geodetic(Waypoint),
/// whether it has latitude and longitude: such are not drawn, the planners publish local ones only.
template <class Policy>
class WaypointMarkers : public rclcpp::Node {
 public:
  explicit WaypointMarkers(const rclcpp::NodeOptions& options)
      : Node("rviz_waypoint_publisher", options) {
    scale_ = declare_number(*this, "waypoint_scale", Policy::kSphere_m, 0.01, 100.0,
                            "diameter of the spheres [m]", true);
    text_ = declare_number(*this, "text_scale", Policy::kText_m, 0.01, 100.0,
                           "height of the numbers [m]", true);
    changes_ = on_change(*this, [this](const rclcpp::Parameter& p) {
      if (p.get_name() == "waypoint_scale") scale_ = p.as_double();
      if (p.get_name() == "text_scale") text_ = p.as_double();
      show(0);
    });
    markers_ = create_latched_publisher<Marker>(*this, "rviz/waypoint", kKept);
    waypoints_ = create_latched_subscription<Waypoint>(
        *this, Policy::kTopic, rosflight::autonomy::kMaxWaypoints + 1,
        [this](typename Waypoint::ConstSharedPtr message) { take(*message); });
  }

 private:
  using Waypoint = typename Policy::Waypoint;
  using Marker = visualization_msgs::msg::Marker;
  /// Three markers each.
  static constexpr std::size_t kKept = 3 * rosflight::autonomy::kMaxWaypoints;

  void take(const Waypoint& message) {
    if (message.clear_wp_list) {
      points_.clear();
      Marker marker;
      marker.action = Marker::DELETEALL;
      markers_->publish(marker);
      return;
    }
    if (Policy::geodetic(message)) return;
    geometry_msgs::msg::Point point;
    point.x = static_cast<double>(message.w[0]);
    point.y = static_cast<double>(message.w[1]);
    point.z = static_cast<double>(message.w[2]);
    points_.push_back(point);
    show(points_.size() - 1);
  }

  Marker marker_of(int type, const char* name, double scale) const {
    Marker marker;  // stamp 0: waypoints stay, RViz shows them at any time
    marker.header.frame_id = "NED";
    marker.ns = name;
    marker.type = type;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = marker.scale.y = marker.scale.z = scale;
    marker.color.g = marker.color.a = 1.0F;
    return marker;
  }

  /// @param from  the first waypoint whose number is not shown as it should be.
  void show(std::size_t from) {
    constexpr double kLine_m = 0.1;
    if (points_.empty()) return;
    Marker spheres = marker_of(Marker::SPHERE_LIST, "waypoints", scale_);
    spheres.points = points_;
    markers_->publish(spheres);
    Marker line = marker_of(Marker::LINE_STRIP, "path", kLine_m);
    line.points = points_;
    markers_->publish(line);
    for (std::size_t k = from; k < points_.size(); ++k) {
      Marker number = marker_of(Marker::TEXT_VIEW_FACING, "numbers", text_);
      number.id = static_cast<int>(k);
      number.text = std::to_string(k + 1);
      number.pose.position = points_[k];
      number.pose.position.z -= scale_;
      markers_->publish(number);
    }
  }

  double scale_{};
  double text_{};
  std::vector<geometry_msgs::msg::Point> points_;
  rclcpp::Publisher<Marker>::SharedPtr markers_;
  typename rclcpp::Subscription<Waypoint>::SharedPtr waypoints_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace rosflight_common
