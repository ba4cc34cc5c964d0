// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace rosflight::log {

/// One ROS 2 message type: its name ("sensor_msgs/msg/Imu") and its definition in ROS interface
/// language. Layouts of rosflight_msgs and roscopter_msgs: ROSflight 2.x (release 2.0.1) and
/// ROScopter 2.0.0; of the common packages: ROS 2 Jazzy. rosflight_log_msgs is ours, for link
/// traffic ROSflight has no message for.
struct MessageDefinition {
  std::string_view name;
  std::string_view text;
};

/// Every type that can occur in a flight log, directly or inside another.
std::span<const MessageDefinition> message_definitions();

/// The definition of `name` followed by those of all types inside it, separated as rosbag2 and
/// Foxglove expect in schemas of encoding "ros2msg": a line of 80 '=' and "MSG: package/Type".
/// @throws LogError for a name that message_definitions() does not have.
std::string schema_text(std::string_view name);

}  // namespace rosflight::log
