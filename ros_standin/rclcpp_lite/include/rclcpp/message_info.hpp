// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rmw/types.h>

namespace rclcpp {

/// What the middleware knows of a received message: times, sender, sequence number.
class MessageInfo {
 public:
  MessageInfo() = default;
  MessageInfo(const rmw_message_info_t& info) : info_(info) {}  // NOLINT: implicit in rclcpp too
  const rmw_message_info_t& get_rmw_message_info() const { return info_; }
  rmw_message_info_t& get_rmw_message_info() { return info_; }

 private:
  rmw_message_info_t info_ = rmw_get_zero_initialized_message_info();
};

}  // namespace rclcpp
