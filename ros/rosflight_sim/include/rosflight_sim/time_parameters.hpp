// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "rosflight_common/node_tools.hpp"

/// Parameters of every time manager, under their names in ROSflight 2.x.
namespace rosflight_sim {

constexpr const char* kStepParameter = "default_pub_rate_us";
constexpr const char* kFactorParameter = "real_time_multiplier";

/// Simulated time of one step [us].
inline double declare_step_us(rclcpp::Node& node) {
  return rosflight_common::declare_number(
      node, kStepParameter, 2500.0, 50.0, 10'000.0,
      "simulated time between two steps; a loop period: lock-step [us]", true);
}

/// Simulated seconds per second of wall time.
inline double declare_factor(rclcpp::Node& node) {
  return rosflight_common::declare_number(node, kFactorParameter, 1.0, 0.01, 100.0,
                                          "simulated seconds per second", true);
}

}  // namespace rosflight_sim
