// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

namespace rclcpp {
class CallbackGroup;
}

namespace rclcpp::detail {

/// Something an executor waits for: a timer, subscription, service or client.
///
/// The executor asks has_work, takes what arrived and executes it. Taking happens under the executor's lock, executing outside of it.
/// When something arrives, the entity wakes its group; only timers are waited for.
class Entity {
 public:
  enum class Kind { kTimer, kSubscription, kService, kClient };
  virtual ~Entity() = default;
  virtual Kind kind() const = 0;
  /// Is there something to take?
  virtual bool has_work() const = 0;
  /// Told once, by the group that has it.
  virtual void set_group(const std::weak_ptr<CallbackGroup>&) {}
  /// What arrived, for execute; null if there was nothing after all.
  virtual std::shared_ptr<void> take() = 0;
  virtual void execute(std::shared_ptr<void> taken) = 0;
};

}  // namespace rclcpp::detail
