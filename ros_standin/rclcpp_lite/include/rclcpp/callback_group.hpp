// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "rclcpp/detail/entity.hpp"
#include "rclcpp/detail/wake_up.hpp"
#include "rclcpp/macros.hpp"

namespace rclcpp {

enum class CallbackGroupType { MutuallyExclusive, Reentrant };

/// Callbacks that may, or may not, run at the same time in a MultiThreadedExecutor.
class CallbackGroup : public std::enable_shared_from_this<CallbackGroup> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(CallbackGroup)
  explicit CallbackGroup(CallbackGroupType type, bool automatically_add = true)
      : type_(type), automatically_add_(automatically_add) {}
  CallbackGroupType type() const { return type_; }
  /// Tells the executor that entities have come or gone.
  void trigger_notify_guard_condition() const;
  bool automatically_add_to_executor_with_node() const { return automatically_add_; }
  std::atomic_bool& can_be_taken_from() { return can_be_taken_from_; }

  // ---- for entities and executors, not for nodes ----
  void add(const std::shared_ptr<detail::Entity>& entity);
  std::vector<std::weak_ptr<detail::Entity>> entities() const;
  /// The executor that waits for this group; null: none does.
  void set_wake_up(const std::shared_ptr<detail::WakeUp>& wake_up);
  bool has_executor() const;
  /// A message has come without the middleware.
  void wake_if_waiting() const;

 private:
  const CallbackGroupType type_;
  const bool automatically_add_;
  std::atomic_bool can_be_taken_from_{true};
  mutable std::mutex mutex_;
  mutable std::vector<std::weak_ptr<detail::Entity>> entities_;
  std::weak_ptr<detail::WakeUp> wake_up_;
};

}  // namespace rclcpp
