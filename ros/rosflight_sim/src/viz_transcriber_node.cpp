// SPDX-License-Identifier: BSD-3-Clause
#include <deque>
#include <optional>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <visualization_msgs/msg/marker.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/while_read.hpp"
#include "rosflight_sim/frames.hpp"

namespace rosflight_sim {
namespace {

using namespace rosflight_common;

using tf2_msgs::msg::TFMessage;
using visualization_msgs::msg::Marker;

/// Truth as RViz reads it: a mesh, the path flown, and the tree of frames (frames.hpp). Only while somebody reads one of them; the path
/// is what was flown while somebody did.
class VizTranscriber : public rclcpp::Node {
 public:
  explicit VizTranscriber(const rclcpp::NodeOptions& options)
      : Node("standalone_viz_transcriber", options) {
    mesh_file_ = declare_text(*this, "sim_aircraft_file", "common_resource/multirotor.stl",
                              "file of the mesh, below the share folder of rosflight_sim");
    scale_ = declare_number(*this, "aircraft_scale", 2.0, 0.01, 1000.0, "scale of the mesh", true);
    path_every_ = declare_integer(*this, "path_publish_modulo", 40, 1, 100'000,
                                  "messages of truth per point of the path", true);
    max_path_ = declare_integer(*this, "max_path_history", 10'000, 2, 1'000'000,
                                "maximum number of points of the path", true);
    prefix_ = declare_text(*this, "frame_prefix", frame_prefix(get_namespace()),
                           "prefix of the names of frames");
    const rclcpp::QoS markers = rclcpp::QoS(rclcpp::KeepLast(5)).reliable();
    mesh_ = create_publisher<Marker>("rviz/mesh", markers);
    path_ = create_publisher<Marker>("rviz/mesh_path", markers);
    tf_ = create_publisher<TFMessage>("/tf", rclcpp::QoS(rclcpp::KeepLast(100)).reliable());
    fixed_ = create_latched_publisher<TFMessage>(*this, "/tf_static", 1);
    changes_ = on_change(*this, [this](const rclcpp::Parameter& p) {
      if (p.get_name() == "aircraft_scale") scale_ = p.as_double();
      if (p.get_name() == "path_publish_modulo") path_every_ = p.as_int();
      if (p.get_name() == "max_path_history") max_path_ = p.as_int();
    });
    publish_fixed_frames();
    publish_mesh(newest_);
    truth_.emplace(*this, WhileRead::Made{mesh_, path_, tf_}, [this] {
      return WhileRead::Subscriptions{create_subscription<rosflight_msgs::msg::SimState>(
          "sim/truth_state", stream(10),
          [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) { show(*message); })};
    });
  }

 private:
  static constexpr std::uint64_t kPoseEvery = 8;  ///< 50 Hz of 400
  static constexpr std::uint64_t kMeshEvery =
      400;  ///< the frame moves the mesh; 1 Hz for late eyes
  /// Stamp of what holds at any time (0 in tf2 and RViz). All others are those of the truth, so this node needs no clock.
  const builtin_interfaces::msg::Time newest_{};

  geometry_msgs::msg::TransformStamped transform(const builtin_interfaces::msg::Time& stamp,
                                                 const std::string& parent,
                                                 const std::string& child) const {
    geometry_msgs::msg::TransformStamped t;
    t.header.stamp = stamp;
    t.header.frame_id = prefix_ + parent;
    t.child_frame_id = prefix_ + child;
    return t;
  }

  void publish_fixed_frames() {
    TFMessage message;
    if (!prefix_.empty()) {  // the trees of all vehicles have one root
      auto t = transform(newest_, "", "map");
      t.header.frame_id = "map";
      t.transform.rotation.w = 1.0;
      message.transforms.push_back(t);
    }
    for (const FrameEdge& edge : fixed_frames()) {
      auto t = transform(newest_, edge.parent, edge.child);
      t.transform.rotation.w = edge.rotation.w();
      t.transform.rotation.x = edge.rotation.x();
      t.transform.rotation.y = edge.rotation.y();
      t.transform.rotation.z = edge.rotation.z();
      message.transforms.push_back(t);
    }
    fixed_->publish(message);
  }

  void publish_mesh(const builtin_interfaces::msg::Time& stamp) {
    constexpr float kGrey = 0.67F;
    Marker marker;
    marker.header.stamp = stamp;
    marker.header.frame_id = prefix_ + "stl_frame";
    marker.ns = "vehicle";
    marker.type = Marker::MESH_RESOURCE;
    marker.mesh_resource = "package://rosflight_sim/" + mesh_file_;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = marker.scale.y = marker.scale.z = scale_;
    marker.color.r = marker.color.g = marker.color.b = kGrey;
    marker.color.a = 1.0F;
    marker.frame_locked = true;
    mesh_->publish(marker);
  }

  void publish_path(const builtin_interfaces::msg::Time& stamp) {
    constexpr double kWidth_m = 0.1;
    Marker marker;
    marker.header.stamp = stamp;
    marker.header.frame_id = prefix_ + "NED";
    marker.ns = "vehicle_path";
    marker.type = Marker::LINE_STRIP;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = kWidth_m;
    marker.color.a = 1.0F;
    marker.points.assign(points_.begin(), points_.end());
    path_->publish(marker);
  }

  void show(const rosflight_msgs::msg::SimState& state) {
    const std::uint64_t count = count_++;
    if (count % kPoseEvery == 0) {
      auto t = transform(state.header.stamp, "NED", "aircraft_body");
      t.transform.translation.x = state.pose.position.x;
      t.transform.translation.y = state.pose.position.y;
      t.transform.translation.z = state.pose.position.z;
      t.transform.rotation = state.pose.orientation;
      TFMessage message;
      message.transforms.push_back(t);
      tf_->publish(message);
    }
    if (count % kMeshEvery == 0) publish_mesh(state.header.stamp);
    if (count % static_cast<std::uint64_t>(path_every_) != 0) return;
    points_.push_back(state.pose.position);
    while (points_.size() > static_cast<std::size_t>(max_path_)) points_.pop_front();
    publish_path(state.header.stamp);
  }

  std::string mesh_file_;
  double scale_{};
  std::int64_t path_every_{};
  std::int64_t max_path_{};
  std::string prefix_;
  std::uint64_t count_{0};
  std::deque<geometry_msgs::msg::Point> points_;
  rclcpp::Publisher<Marker>::SharedPtr mesh_, path_;
  rclcpp::Publisher<TFMessage>::SharedPtr tf_, fixed_;
  std::optional<WhileRead> truth_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::VizTranscriber, SingleThreadedExecutor)
