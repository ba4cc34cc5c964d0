// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "io_node.hpp"
#include "rosflight_io/realtime_configurator.hpp"

/// Exit code 2 and one line for a link that cannot be or a parameter that makes no sense.
int main(int argc, char** argv) {
  constexpr int kBadInput = 2;
  try {
    const rosflight_io::RealtimeConfigurator realtime{argc, argv};
    realtime.apply();
    rclcpp::init(argc, argv);
    const auto node = std::make_shared<rosflight_io::IoNode>();
    const auto watch = realtime.watch(*node);
    RCLCPP_INFO(node->get_logger(), "ready");
    rclcpp::spin(node);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rosflight_io: %s\n", error.what());
    return kBadInput;
  }
  rclcpp::shutdown();
  return 0;
}
