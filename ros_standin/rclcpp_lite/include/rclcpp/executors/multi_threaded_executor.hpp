// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>

#include "rclcpp/executor.hpp"

namespace rclcpp::executors {

/// Calls callbacks from several threads: those of one mutually exclusive group one at a time.
class MultiThreadedExecutor : public Executor {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(MultiThreadedExecutor)
  /// No number of threads: as many as processors, at least two.
  explicit MultiThreadedExecutor(const ExecutorOptions& options = ExecutorOptions(),
                                 std::size_t number_of_threads = 0,
                                 bool yield_before_execute = false,
                                 std::chrono::nanoseconds timeout = std::chrono::nanoseconds(-1));
  void spin() override;
  std::size_t get_number_of_threads() const { return threads_; }

 private:
  void work();
  std::size_t threads_;
  bool yield_;
  std::chrono::nanoseconds timeout_;
};

}  // namespace rclcpp::executors
