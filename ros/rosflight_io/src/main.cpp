// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_io/io_node.hpp"
#include "rosflight_io/realtime_configurator.hpp"

/// Exit code 2 and one line for a link that cannot be or a parameter that makes no sense; 1 for one
/// that failed later.
int main(int argc, char** argv) {
  constexpr int kBroken = 1;
  constexpr int kBadInput = 2;
  bool started = false;
  try {
    const rosflight_io::RealtimeConfigurator realtime{argc, argv};
    realtime.apply();
    rclcpp::init(argc, argv);
    started = true;
    const auto node = std::make_shared<rosflight_io::IoNode>();
    const auto threads = realtime.watch(*node);
    const auto clock = rosflight_common::warn_without_clock(*node);
    RCLCPP_INFO(node->get_logger(), "ready");
    rclcpp::spin(node);
    if (node->link_failed()) return kBroken;
  } catch (const std::exception& error) {
    // SIGINT while the node is being made leaves nothing to make it in: an end like any other.
    if (started && !rclcpp::ok()) return 0;
    std::fprintf(stderr, "rosflight_io: %s\n", error.what());
    return kBadInput;
  }
  rclcpp::shutdown();
  return 0;
}
