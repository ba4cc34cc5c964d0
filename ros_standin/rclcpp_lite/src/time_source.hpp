// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <rosgraph_msgs/msg/clock.hpp>
#include <thread>

#include "node_parameters.hpp"
#include "rclcpp/executors/single_threaded_executor.hpp"

namespace rclcpp::detail {

/// Follows the parameter use_sim_time: puts what comes on /clock into the node's clock.
class TimeSource {
 public:
  TimeSource(node_interfaces::NodeBaseInterface::SharedPtr base, Clock::SharedPtr clock,
             NodeParameters& parameters, const NodeOptions& options);
  TimeSource(const TimeSource&) = delete;
  TimeSource& operator=(const TimeSource&) = delete;
  ~TimeSource();

 private:
  void use_simulated_time(bool on);
  void start_listening();
  void stop_listening();

  node_interfaces::NodeBaseInterface::SharedPtr base_;
  Clock::SharedPtr clock_;
  NodeParameters& parameters_;
  const QoS qos_;
  const std::shared_ptr<IntraProcessTopics> topics_;  ///< Null: by the middleware only.
  const bool own_thread_;
  std::mutex mutex_;
  bool on_{false};
  CallbackGroup::SharedPtr group_;
  Subscription<rosgraph_msgs::msg::Clock>::SharedPtr subscription_;
  std::unique_ptr<executors::SingleThreadedExecutor> executor_;
  std::thread thread_;
};

}  // namespace rclcpp::detail
