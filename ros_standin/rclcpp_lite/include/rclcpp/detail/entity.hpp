// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/wait.h>

#include <cstddef>
#include <memory>

namespace rclcpp {
class CallbackGroup;
}

namespace rclcpp::detail {

/// Something an executor waits for: a timer, subscription, service or client.
///
/// The executor calls add_to, waits, asks is_ready, then takes what arrived and executes it. Taking
/// happens under the executor's lock, executing outside of it.
class Entity {
 public:
  enum class Kind { kTimer, kSubscription, kService, kClient };
  virtual ~Entity() = default;
  virtual Kind kind() const = 0;
  /// Puts itself into the set and remembers where.
  virtual void add_to(rcl_wait_set_t& set) = 0;
  /// After the wait: is there something to take?
  virtual bool is_ready(const rcl_wait_set_t& set) const = 0;
  /// Is there something to take that did not come by the middleware?
  virtual bool has_own() const { return false; }
  /// Told once, by the group that has it.
  virtual void set_group(const std::weak_ptr<CallbackGroup>&) {}
  /// May what comes wait for a moment? See Executor.
  virtual bool is_seldom() const { return false; }
  /// What arrived, for execute; null if there was nothing after all.
  virtual std::shared_ptr<void> take() = 0;
  virtual void execute(std::shared_ptr<void> taken) = 0;
};

}  // namespace rclcpp::detail
