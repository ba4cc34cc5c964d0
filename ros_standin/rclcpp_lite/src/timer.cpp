// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/timer.hpp"

#include <rcl/error_handling.h>

#include <stdexcept>

#include "rcl_call.hpp"

namespace rclcpp {

TimerBase::TimerBase(Clock::SharedPtr clock, std::chrono::nanoseconds period,
                     Context::SharedPtr context)
    : clock_(std::move(clock)),
      context_(context->get_rcl_context()),
      timer_(rcl_get_zero_initialized_timer()) {
  if (period.count() < 0) throw std::invalid_argument("a timer's period cannot be negative");
  if (!context_) throw std::runtime_error("rclcpp::init has not been called");
  const std::lock_guard<std::recursive_mutex> lock(clock_->get_clock_mutex());
  detail::check(rcl_timer_init2(&timer_, clock_->get_clock_handle(), context_.get(), period.count(),
                                nullptr, rcl_get_default_allocator(), true),
                "make a timer");
}

TimerBase::~TimerBase() {
  const std::lock_guard<std::recursive_mutex> lock(clock_->get_clock_mutex());
  detail::complain(rcl_timer_fini(&timer_), "end a timer");
}

void TimerBase::cancel() {
  detail::check(rcl_timer_cancel(&timer_), "cancel a timer");
}

bool TimerBase::is_canceled() {
  bool canceled = false;
  detail::check(rcl_timer_is_canceled(&timer_, &canceled), "ask a timer");
  return canceled;
}

void TimerBase::reset() {
  const std::lock_guard<std::recursive_mutex> lock(clock_->get_clock_mutex());
  detail::check(rcl_timer_reset(&timer_), "reset a timer");
}

bool TimerBase::is_ready() const {
  bool ready = false;
  detail::check(rcl_timer_is_ready(&timer_, &ready), "ask a timer");
  return ready;
}

std::chrono::nanoseconds TimerBase::time_until_trigger() {
  std::int64_t left = 0;
  const auto code = rcl_timer_get_time_until_next_call(&timer_, &left);
  if (code == RCL_RET_TIMER_CANCELED) {
    rcl_reset_error();
    return std::chrono::nanoseconds::max();
  }
  detail::check(code, "ask a timer");
  return std::chrono::nanoseconds(left);
}

void TimerBase::add_to(rcl_wait_set_t& set) const {
  detail::check(rcl_wait_set_add_timer(&set, &timer_, nullptr), "wait for a timer");
}

std::shared_ptr<void> TimerBase::take() {
  const auto code = rcl_timer_call(&timer_);
  if (code == RCL_RET_TIMER_CANCELED) {
    rcl_reset_error();
    return nullptr;
  }
  detail::check(code, "call a timer");
  return {&timer_, [](void*) {}};  // only marks the callback as due
}

}  // namespace rclcpp
