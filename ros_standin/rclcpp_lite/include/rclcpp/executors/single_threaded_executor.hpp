// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rclcpp/executor.hpp"

namespace rclcpp::executors {

/// Calls all callbacks from the thread that spins.
class SingleThreadedExecutor : public Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(SingleThreadedExecutor)
  using Executor::Executor;
  void spin() override;
};

}  // namespace rclcpp::executors
