// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rosflight_common {

/// Messages of `messages/` as those of ROS and back; the two have the same fields.
/// @param Ros  for example sensor_msgs::msg::Range, beside Message messages::sensor_msgs::Range.
template <class Ros, class Message>
Ros to_ros(const Message& message) {
  Ros ros;
  Message::copy(message, ros);
  return ros;
}

template <class Message, class Ros>
Message from_ros(const Ros& ros) {
  Message message;
  Message::copy(ros, message);
  return message;
}

}  // namespace rosflight_common
