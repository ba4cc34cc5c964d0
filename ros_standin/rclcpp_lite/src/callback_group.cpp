// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/callback_group.hpp"

#include <algorithm>

namespace rclcpp {

void CallbackGroup::add(const std::shared_ptr<detail::Entity>& entity) {
  entity->set_group(weak_from_this());
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    entities_.push_back(entity);
  }
  trigger_notify_guard_condition();
}

void CallbackGroup::trigger_notify_guard_condition() const {
  std::shared_ptr<detail::WakeUp> wake_up;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_up = wake_up_.lock();
  }
  if (wake_up) wake_up->set_changed();
}

std::vector<std::weak_ptr<detail::Entity>> CallbackGroup::entities() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto gone = std::remove_if(entities_.begin(), entities_.end(),
                                   [](const auto& entity) { return entity.expired(); });
  entities_.erase(gone, entities_.end());
  return entities_;
}

void CallbackGroup::set_wake_up(const std::shared_ptr<detail::WakeUp>& wake_up) {
  const std::lock_guard<std::mutex> lock(mutex_);
  wake_up_ = wake_up;
}

void CallbackGroup::wake_if_waiting() const {
  std::shared_ptr<detail::WakeUp> wake_up;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wake_up = wake_up_.lock();
  }
  if (wake_up) wake_up->trigger_if_waiting();
}

bool CallbackGroup::has_executor() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return !wake_up_.expired();
}

}  // namespace rclcpp
