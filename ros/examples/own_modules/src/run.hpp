// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

/// Names on the command line and the nodes that they start.
using Modules = std::vector<std::pair<std::string, std::function<rclcpp::Node::SharedPtr()>>>;

/// The main() of each program here: runs the modules named on the command line, or all of them, in one thread.
inline int run(int argc, char** argv, const Modules& modules) {
  const auto words = rclcpp::init_and_remove_ros_arguments(argc, argv);
  std::vector<rclcpp::Node::SharedPtr> nodes;
  for (const auto& [name, make] : modules) {
    if (words.size() <= 1 || std::find(words.begin() + 1, words.end(), name) != words.end())
      nodes.push_back(make());
  }
  rclcpp::executors::SingleThreadedExecutor executor;
  for (const auto& node : nodes) {
    executor.add_node(node);
    RCLCPP_INFO(node->get_logger(), "ready");
  }
  executor.spin();
  rclcpp::shutdown();
  return 0;
}
