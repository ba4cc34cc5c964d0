// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <atomic>
#include <rclcpp/rclcpp.hpp>

#include "companion/time.hpp"

namespace rosflight_io {

/// Time of the companion's session, and what it is in ROS time.
///
/// Wall time: the session runs on the steady clock; a stamp moves to ROS time by the present
/// difference of the two, so a step of the system clock moves stamps and nothing else. Simulated
/// time (use_sim_time): the session runs on the node's clock, as the simulated FCU does, and
/// stands still while that pauses; a jump back holds it until the clock has caught up.
class Clock {
 public:
  explicit Clock(rclcpp::Clock::SharedPtr ros_clock);

  /// Never goes back.
  rosflight::companion::Time now();
  rclcpp::Time to_ros(rosflight::companion::Time t);
  /// Simulated time began then, as far as now() saw; of what was before there is no time. Wall time has no begin.
  rosflight::companion::Time begin() const { return rosflight::companion::Time{begin_ns_}; }
  bool simulated() const { return simulated_; }
  /// There is a time to synchronise with: simulated time has none before its first /clock.
  bool runs() const { return !simulated_ || ros_->now().nanoseconds() > 0; }

 private:
  rclcpp::Clock::SharedPtr ros_;
  bool simulated_;
  std::atomic<std::int64_t> latest_ns_{0};
  std::atomic<std::int64_t> begin_ns_{0};
};

}  // namespace rosflight_io
