// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/guard_condition.h>

#include <atomic>
#include <cstdint>
#include <memory>

#include "rclcpp/context.hpp"

namespace rclcpp::detail {

/// Wakes an executor that waits. Its generation shows the executor whether the set of things to
/// wait for is still the one it knows.
class WakeUp {
 public:
  explicit WakeUp(const Context::SharedPtr& context);
  WakeUp(const WakeUp&) = delete;
  WakeUp& operator=(const WakeUp&) = delete;
  ~WakeUp();
  void trigger();
  /// While it is set, what comes without the middleware triggers. Set before the executor looks for such things.
  void set_waiting(bool waiting) { waiting_ = waiting; }
  void trigger_if_waiting() {
    if (waiting_) trigger();
  }
  void set_changed() {
    ++generation_;
    trigger();
  }
  std::uint64_t generation() const { return generation_; }
  const rcl_guard_condition_t* handle() const { return &condition_; }

 private:
  std::shared_ptr<rcl_context_t> context_;
  rcl_guard_condition_t condition_;
  std::atomic<std::uint64_t> generation_{1};
  std::atomic_bool waiting_{false};
};

}  // namespace rclcpp::detail
