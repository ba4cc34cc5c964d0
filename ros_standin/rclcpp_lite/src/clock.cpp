// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/clock.hpp"

#include <stdexcept>

#include "rcl_call.hpp"

namespace rclcpp {

Clock::Clock(rcl_clock_type_t type) {
  auto allocator = rcl_get_default_allocator();
  detail::check(rcl_clock_init(type, &clock_, &allocator), "make a clock");
}

Clock::~Clock() {
  detail::complain(rcl_clock_fini(&clock_), "end a clock");
}

Time Clock::now() const {
  rcl_time_point_t point{0, clock_.type};
  detail::check(rcl_clock_get_now(&clock_, &point.nanoseconds), "read a clock");
  return Time(point);
}

bool Clock::ros_time_is_active() {
  if (clock_.type != RCL_ROS_TIME) return false;
  bool active = false;
  detail::check(rcl_is_enabled_ros_time_override(&clock_, &active), "ask for simulated time");
  return active;
}

bool Clock::sleep_for(Duration span, Context::SharedPtr context) {
  return sleep_until(now() + span, std::move(context));
}

bool Clock::sleep_until(Time until, Context::SharedPtr context) {
  if (!context || !context->is_valid()) throw std::runtime_error("sleep needs a valid context");
  if (until.get_clock_type() != get_clock_type()) {
    throw std::runtime_error("sleep until a time of another kind of clock");
  }
  if (ros_time_is_active()) return sleep_on_simulated_time(until, context);
  const auto span = std::chrono::nanoseconds((until - now()).nanoseconds());
  return span.count() <= 0 || context->sleep_for(span);
}

bool Clock::sleep_on_simulated_time(const Time& until, const Context::SharedPtr& context) {
  std::mutex mutex;
  std::condition_variable woken;
  bool changed = false;
  const auto wake = [&] {
    { const std::lock_guard<std::mutex> lock(mutex); }
    woken.notify_all();
  };
  // The smallest step of time counts.
  const rcl_jump_threshold_t any{true, {1}, {-1}};
  const auto handler = create_jump_callback(
      nullptr,
      [&](const rcl_time_jump_t& jump) {
        if (jump.clock_change != RCL_ROS_TIME_NO_CHANGE) {
          const std::lock_guard<std::mutex> lock(mutex);
          changed = true;
        }
        wake();
      },
      any);
  const auto at_shutdown = context->add_on_shutdown_callback(wake);
  {
    std::unique_lock<std::mutex> lock(mutex);
    woken.wait(lock, [&] { return changed || !context->is_valid() || now() >= until; });
  }
  context->remove_on_shutdown_callback(at_shutdown);
  return !changed && context->is_valid();
}

void Clock::on_jump(const rcl_time_jump_t* jump, bool before, void* handler) {
  const auto* const called = static_cast<JumpHandler*>(handler);
  if (before && called->pre_callback) called->pre_callback();
  if (!before && called->post_callback) called->post_callback(*jump);
}

JumpHandler::SharedPtr Clock::create_jump_callback(JumpHandler::pre_callback_t pre,
                                                   JumpHandler::post_callback_t post,
                                                   const rcl_jump_threshold_t& threshold) {
  auto handler = std::make_unique<JumpHandler>(std::move(pre), std::move(post), threshold);
  {
    const std::lock_guard<std::recursive_mutex> lock(mutex_);
    detail::check(rcl_clock_add_jump_callback(&clock_, threshold, on_jump, handler.get()),
                  "watch a clock");
  }
  return {handler.release(), [this](JumpHandler* ended) {
            {
              const std::lock_guard<std::recursive_mutex> lock(mutex_);
              detail::complain(rcl_clock_remove_jump_callback(&clock_, on_jump, ended),
                               "stop watching a clock");
            }
            delete ended;
          }};
}

}  // namespace rclcpp
