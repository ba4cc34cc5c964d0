// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/timer.h>
#include <rcl/wait.h>

#include <chrono>
#include <functional>
#include <memory>
#include <type_traits>

#include "rclcpp/clock.hpp"
#include "rclcpp/context.hpp"
#include "rclcpp/detail/arguments.hpp"
#include "rclcpp/detail/entity.hpp"

namespace rclcpp {

/// Calls back each period of its clock. A call that comes late does not move the later ones.
class TimerBase : public detail::Entity {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(TimerBase)
  TimerBase(Clock::SharedPtr clock, std::chrono::nanoseconds period, Context::SharedPtr context);
  TimerBase(const TimerBase&) = delete;
  TimerBase& operator=(const TimerBase&) = delete;
  ~TimerBase() override;

  void cancel();
  bool is_canceled();
  /// Starts the period again; also starts a cancelled timer.
  void reset();
  /// True when the period is over.
  bool is_ready() const;
  bool is_steady() const { return clock_->get_clock_type() == RCL_STEADY_TIME; }
  /// Negative when overdue, std::chrono::nanoseconds::max() when cancelled.
  std::chrono::nanoseconds time_until_trigger();

  Kind kind() const override { return Kind::kTimer; }
  bool has_work() const override { return is_ready(); }
  /// A wait with the set ends when the period is over.
  void add_to(rcl_wait_set_t& set) const;
  std::shared_ptr<void> take() override;

 private:
  Clock::SharedPtr clock_;
  std::shared_ptr<rcl_context_t> context_;
  rcl_timer_t timer_;
};

namespace detail {
/// Does a timer take the callback: void() or void(TimerBase&)?
template <typename CallbackT>
inline constexpr bool kTimerTakes = kDeclares<CallbackT> || kDeclares<CallbackT, TimerBase&>;
}  // namespace detail

/// A timer with its callback: void() or void(TimerBase&).
template <typename FunctorT>
class GenericTimer : public TimerBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(GenericTimer)
  static_assert(
      detail::kTimerTakes<FunctorT>,
      "rclcpp takes void() or void(TimerBase&) with a const call operator: no mutable lambda");
  GenericTimer(Clock::SharedPtr clock, std::chrono::nanoseconds period, FunctorT&& callback,
               Context::SharedPtr context)
      : TimerBase(std::move(clock), period, std::move(context)),
        callback_(std::forward<FunctorT>(callback)) {}
  void execute(std::shared_ptr<void>) override {
    if constexpr (std::is_invocable_v<FunctorT&, TimerBase&>) {
      callback_(*this);
    } else {
      callback_();
    }
  }

 private:
  FunctorT callback_;
};

/// A timer on steady time.
template <typename FunctorT>
class WallTimer : public GenericTimer<FunctorT> {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(WallTimer)
  WallTimer(std::chrono::nanoseconds period, FunctorT&& callback, Context::SharedPtr context)
      : GenericTimer<FunctorT>(std::make_shared<Clock>(RCL_STEADY_TIME), period,
                               std::forward<FunctorT>(callback), std::move(context)) {}
};

}  // namespace rclcpp
