// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/time.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>

#include "rclcpp/context.hpp"
#include "rclcpp/macros.hpp"
#include "rclcpp/time.hpp"

namespace rclcpp {

class Clock;

/// Calls on a jump of the clock until it is destroyed.
class JumpHandler {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(JumpHandler)
  using pre_callback_t = std::function<void()>;
  using post_callback_t = std::function<void(const rcl_time_jump_t&)>;
  JumpHandler(pre_callback_t pre, post_callback_t post, const rcl_jump_threshold_t& threshold)
      : pre_callback(std::move(pre)), post_callback(std::move(post)), notice_threshold(threshold) {}
  pre_callback_t pre_callback;
  post_callback_t post_callback;
  rcl_jump_threshold_t notice_threshold;
};

/// A source of time. ROS time is system time until simulated time is switched on.
class Clock {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Clock)
  explicit Clock(rcl_clock_type_t type = RCL_SYSTEM_TIME);
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  ~Clock();

  Time now() const;

  /// Sleeps until the clock shows `until`, woken by jumps. False: the context was shut down first,
  /// or simulated time was switched on or off. Throws if `until` is of another kind of clock.
  bool sleep_until(Time until, Context::SharedPtr context = contexts::get_global_default_context());
  bool sleep_for(Duration span,
                 Context::SharedPtr context = contexts::get_global_default_context());

  /// True when this is ROS time and it is simulated.
  bool ros_time_is_active();
  rcl_clock_type_t get_clock_type() const { return clock_.type; }
  rcl_clock_t* get_clock_handle() { return &clock_; }
  /// Held while the clock's callbacks are changed or called.
  std::recursive_mutex& get_clock_mutex() { return mutex_; }

  JumpHandler::SharedPtr create_jump_callback(JumpHandler::pre_callback_t pre,
                                              JumpHandler::post_callback_t post,
                                              const rcl_jump_threshold_t& threshold);

 private:
  static void on_jump(const rcl_time_jump_t* jump, bool before, void* handler);
  bool sleep_on_simulated_time(const Time& until, const Context::SharedPtr& context);

  mutable rcl_clock_t clock_{};
  std::recursive_mutex mutex_;
};

}  // namespace rclcpp
