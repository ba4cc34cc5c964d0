// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "io_node.hpp"

/// Exit code 2 and one line for a link that cannot be or a parameter that makes no sense.
int main(int argc, char** argv) {
  constexpr int kBadInput = 2;
  try {
    rclcpp::init(argc, argv);
    const auto node = std::make_shared<rosflight_io::IoNode>();
    RCLCPP_INFO(node->get_logger(), "ready");
    rclcpp::spin(node);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rosflight_io: %s\n", error.what());
    return kBadInput;
  }
  rclcpp::shutdown();
  return 0;
}
