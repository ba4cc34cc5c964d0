// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>

namespace rosflight_common {

/// Publisher whose newest `depth` messages are kept for subscriptions that come later (transient local).
///
/// Always by the middleware: rclcpp 16 refuses to pass such topics on within a process, which compose and component containers
/// (use_intra_process_comms) ask their nodes for.
template <typename MessageT>
typename rclcpp::Publisher<MessageT>::SharedPtr create_latched_publisher(rclcpp::Node& node,
                                                                         const std::string& topic,
                                                                         std::size_t depth) {
  rclcpp::PublisherOptions options;
  options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
  return node.create_publisher<MessageT>(topic, rclcpp::QoS(depth).transient_local(), options);
}

/// Subscription to such a topic: it gets what was published before, too.
template <typename MessageT, typename CallbackT>
typename rclcpp::Subscription<MessageT>::SharedPtr create_latched_subscription(
    rclcpp::Node& node, const std::string& topic, std::size_t depth, CallbackT&& callback) {
  rclcpp::SubscriptionOptions options;
  options.use_intra_process_comm = rclcpp::IntraProcessSetting::Disable;
  return node.create_subscription<MessageT>(topic, rclcpp::QoS(depth).transient_local(),
                                            std::forward<CallbackT>(callback), options);
}

}  // namespace rosflight_common
