// SPDX-License-Identifier: BSD-3-Clause
// Attitude and magnetic field as poses and points for RViz, all in the frame "fixed_frame".
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <geometry_msgs/msg/point.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/quaternion.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <visualization_msgs/msg/marker.hpp>

#include "rosflight_common/component.hpp"

namespace rosflight_gcs {

using geometry_msgs::msg::PoseStamped;
using sensor_msgs::msg::MagneticField;
using visualization_msgs::msg::Marker;

constexpr const char* kFrame = "fixed_frame";
constexpr double kUnitsPerTesla = 1e5;
constexpr std::size_t kMaxCloud = 5000;

/// The rotation that turns the x axis along a vector: yaw about z, then pitch about y; no roll.
geometry_msgs::msg::Quaternion along(double x, double y, double z) {
  const double half_yaw = 0.5 * std::atan2(y, x);
  const double half_pitch = 0.5 * std::atan2(-z, std::hypot(x, y));
  geometry_msgs::msg::Quaternion q;
  q.w = std::cos(half_yaw) * std::cos(half_pitch);
  q.x = -std::sin(half_yaw) * std::sin(half_pitch);
  q.y = std::cos(half_yaw) * std::sin(half_pitch);
  q.z = std::sin(half_yaw) * std::cos(half_pitch);
  return q;
}

class VizNode final : public rclcpp::Node {
 public:
  explicit VizNode(const rclcpp::NodeOptions& options) : Node("viz_node", options) {
    attitude_ = create_publisher<PoseStamped>("viz/attitude", 1);
    field_ = create_publisher<PoseStamped>("viz/magnetometer", 1);
    points_ = create_publisher<Marker>("viz/cloud", 1);
    cloud_.header.frame_id = kFrame;
    cloud_.type = Marker::POINTS;
    cloud_.action = Marker::ADD;
    cloud_.pose.orientation.w = 1.0;
    cloud_.scale.x = cloud_.scale.y = 0.05;
    cloud_.color.g = cloud_.color.a = 1.0F;
    attitude_in_ = create_subscription<rosflight_msgs::msg::Attitude>(
        "attitude", 1,
        [this](rosflight_msgs::msg::Attitude::ConstSharedPtr m) { show_attitude(*m); });
    field_in_ = create_subscription<MagneticField>(
        "magnetometer", 1, [this](MagneticField::ConstSharedPtr m) { show_field(*m); });
    timer_ = create_wall_timer(std::chrono::milliseconds(100), [this] { show_cloud(); });
  }

 private:
  void show_attitude(const rosflight_msgs::msg::Attitude& m) {
    PoseStamped pose;
    pose.header.stamp = m.header.stamp;
    pose.header.frame_id = kFrame;
    pose.pose.orientation = m.attitude;
    attitude_->publish(pose);
  }

  void show_field(const MagneticField& m) {
    PoseStamped pose;
    pose.header.stamp = m.header.stamp;
    pose.header.frame_id = kFrame;
    pose.pose.orientation = along(m.magnetic_field.x, m.magnetic_field.y, m.magnetic_field.z);
    field_->publish(pose);
    geometry_msgs::msg::Point point;
    point.x = kUnitsPerTesla * m.magnetic_field.x;
    point.y = kUnitsPerTesla * m.magnetic_field.y;
    point.z = kUnitsPerTesla * m.magnetic_field.z;
    cloud_.header.stamp = m.header.stamp;
    if (cloud_.points.size() < kMaxCloud) {
      cloud_.points.push_back(point);
    } else {
      cloud_.points[oldest_] = point;
      oldest_ = (oldest_ + 1) % kMaxCloud;
    }
    cloud_is_new_ = true;
  }

  void show_cloud() {
    if (!cloud_is_new_) return;
    points_->publish(cloud_);
    cloud_is_new_ = false;
  }

  rclcpp::Publisher<PoseStamped>::SharedPtr attitude_;
  rclcpp::Publisher<PoseStamped>::SharedPtr field_;
  rclcpp::Publisher<Marker>::SharedPtr points_;
  rclcpp::Subscription<rosflight_msgs::msg::Attitude>::SharedPtr attitude_in_;
  rclcpp::Subscription<MagneticField>::SharedPtr field_in_;
  rclcpp::TimerBase::SharedPtr timer_;
  Marker cloud_;
  std::size_t oldest_{0};
  bool cloud_is_new_{false};
};

}  // namespace rosflight_gcs

ROSFLIGHT_NODE(rosflight_gcs::VizNode, SingleThreadedExecutor)
