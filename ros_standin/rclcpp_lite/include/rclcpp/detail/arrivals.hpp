// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <utility>

#include "rclcpp/callback_group.hpp"

namespace rclcpp::detail {

/// Whether the middleware has brought something for an entity since it was last found empty. A thread of the middleware tells it, and
/// the group's executor wakes if it waits.
class Arrivals {
 public:
  Arrivals() = default;
  Arrivals(const Arrivals&) = delete;
  Arrivals& operator=(const Arrivals&) = delete;

  /// Once, before rcl is given `come`.
  void set_group(std::weak_ptr<CallbackGroup> group) { group_ = std::move(group); }
  /// A callback of rcl; `self` are these arrivals.
  static void come(const void* self, std::size_t) {
    // rcl hands out what it was given as const.
    auto& arrivals = *const_cast<Arrivals*>(static_cast<const Arrivals*>(self));
    arrivals.there_ = true;
    if (const auto group = arrivals.group_.lock()) group->wake_if_waiting();
  }
  bool any() const { return there_; }
  /// @param take  asks rcl for one; after one that it found there may be more
  template <typename TakeT>
  bool take(TakeT&& take) {
    there_ = false;  // before it looks: what comes from here on counts
    const bool taken = take();
    if (taken) there_ = true;
    return taken;
  }

 private:
  std::atomic_bool there_{false};
  std::weak_ptr<CallbackGroup> group_;
};

}  // namespace rclcpp::detail
