// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <memory>
#include <utility>

#include "rclcpp/node.hpp"

namespace rclcpp {

/// A timer on any clock, ROS time included. `node` points to a node in any way.
template <typename NodeT, typename CallbackT>
typename TimerBase::SharedPtr create_timer(NodeT node, Clock::SharedPtr clock, Duration period,
                                           CallbackT&& callback,
                                           CallbackGroup::SharedPtr group = nullptr) {
  const auto base = node->get_node_base_interface();
  using Timer = GenericTimer<std::decay_t<CallbackT>>;
  auto timer = std::make_shared<Timer>(
      std::move(clock), period.to_chrono<std::chrono::nanoseconds>(),
      std::decay_t<CallbackT>(std::forward<CallbackT>(callback)), base->get_context());
  (group ? group : base->get_default_callback_group())->add(timer);
  return timer;
}

}  // namespace rclcpp
