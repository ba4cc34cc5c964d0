// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/world_topics.hpp"

#include <geometry_msgs/msg/pose_stamped.hpp>
#include <map>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <tf2_msgs/msg/tf_message.hpp>
#include <tuple>
#include <utility>

#include "messages/link.hpp"
#include "messages/world_sensors.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/frames.hpp"
#include "sim/world/read_sdf.hpp"

namespace rosflight_sim {

namespace messages = rosflight::messages;

namespace {

using namespace rosflight_common;

/// The type of ROS for each message of a sample.
template <class Message>
struct RosType;
template <>
struct RosType<messages::sensor_msgs::LaserScan> {
  using type = sensor_msgs::msg::LaserScan;
};
template <>
struct RosType<messages::sensor_msgs::Image> {
  using type = sensor_msgs::msg::Image;
};
template <>
struct RosType<messages::sensor_msgs::CameraInfo> {
  using type = sensor_msgs::msg::CameraInfo;
};
template <>
struct RosType<messages::geometry_msgs::PoseStamped> {
  using type = geometry_msgs::msg::PoseStamped;
};
template <>
struct RosType<messages::sensor_msgs::Range> {
  using type = sensor_msgs::msg::Range;
};

template <class Ros>
using PublisherMap = std::map<std::string, typename rclcpp::Publisher<Ros>::SharedPtr>;

}  // namespace

/// By topic, each made with its first message.
struct WorldTopics::Publishers {
  std::tuple<PublisherMap<sensor_msgs::msg::LaserScan>, PublisherMap<sensor_msgs::msg::Image>,
             PublisherMap<sensor_msgs::msg::CameraInfo>,
             PublisherMap<geometry_msgs::msg::PoseStamped>, PublisherMap<sensor_msgs::msg::Range>>
      all;
  rclcpp::Publisher<tf2_msgs::msg::TFMessage>::SharedPtr fixed;

  template <class Ros>
  rclcpp::Publisher<Ros>& of(rclcpp::Node& node, const std::string& topic) {
    auto& publisher = std::get<PublisherMap<Ros>>(all)[topic];
    if (!publisher) publisher = node.create_publisher<Ros>(topic, newest());
    return *publisher;
  }
};

WorldTopics::WorldTopics(rclcpp::Node& node, const sim::Registry& registry,
                         const VehicleParameters& vehicle, sim::Time step)
    : node_{node}, publishers_{std::make_shared<Publishers>()} {
  if (vehicle.vehicle.world_sensors().keys().empty()) return;
  const std::string file =
      declare_text(node, "world_file", "", "SDF file with the shapes that world_sensors measure");
  prefix_ = frame_prefix(node.get_namespace());
  if (!file.empty()) shapes_ = sim::world::read_sdf_world(file);
  if (vehicle.vehicle.ground().model != sim::GroundModel::kNone) shapes_.add_level_ground();
  sensors_ = sim::WorldSensors(registry, vehicle.vehicle, shapes_, vehicle.random, step);
  publish_frames(vehicle);
}

void WorldTopics::publish_frames(const VehicleParameters& vehicle) {
  tf2_msgs::msg::TFMessage frames;
  const sim::Vector3& centre_B = vehicle.vehicle.body().centre_of_mass_B;
  for (const sim::WorldSensors::Entry& entry : sensors_.entries()) {
    const sim::Mounting* mounting = entry.sensor->mounting();
    if (mounting == nullptr) continue;
    auto message = to_ros<tf2_msgs::msg::TFMessage>(messages::sensor_frames(
        {}, prefix_ + entry.name, mounting->position_m - centre_B, sim::R_BS(*mounting)));
    message.transforms.front().header.frame_id = prefix_ + "aircraft_body";
    for (auto& transform : message.transforms) frames.transforms.push_back(std::move(transform));
  }
  if (frames.transforms.empty()) return;
  publishers_->fixed = create_latched_publisher<tf2_msgs::msg::TFMessage>(node_, "/tf_static", 1);
  publishers_->fixed->publish(frames);
}

void WorldTopics::step(const sim::Truth& truth, std::int64_t stamp_ns) {
  constexpr std::int64_t kMicrosecond_ns = 1000;
  sensors_.step(truth, [&](const std::string& name, const sim::WorldSample& sample) {
    const std::int64_t age_us = (truth.time - messages::measured_at(sample)).count();
    const auto measured_ns = static_cast<std::uint64_t>(stamp_ns - age_us * kMicrosecond_ns);
    const auto put = [&]<class Message>(const std::string& topic, Message message) {
      using Ros = typename RosType<Message>::type;
      message.header.frame_id.insert(0, prefix_);
      publishers_->of<Ros>(node_, topic).publish(to_ros<Ros>(message));
    };
    messages::put_sample(messages::stamp_of(measured_ns), name, sample, put);
  });
}

}  // namespace rosflight_sim
