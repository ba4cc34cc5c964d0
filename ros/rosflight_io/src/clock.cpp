// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_io/clock.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace rosflight_io {
namespace {

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

Clock::Clock(rclcpp::Clock::SharedPtr ros_clock)
    : ros_{std::move(ros_clock)}, simulated_{ros_->ros_time_is_active()} {}

rosflight::companion::Time Clock::now() {
  if (!simulated_) return rosflight::companion::Time{steady_ns()};
  const std::int64_t now = ros_->now().nanoseconds();
  std::int64_t none = 0;
  begin_ns_.compare_exchange_strong(none, now);
  std::int64_t latest = latest_ns_;
  while (now > latest && !latest_ns_.compare_exchange_weak(latest, now)) {
  }
  return rosflight::companion::Time{std::max(now, latest)};
}

rclcpp::Time Clock::to_ros(rosflight::companion::Time t) {
  std::int64_t ns = t.count();
  if (!simulated_) ns += ros_->now().nanoseconds() - steady_ns();
  return rclcpp::Time(std::max<std::int64_t>(ns, 0), ros_->get_clock_type());
}

}  // namespace rosflight_io
