// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/rate.hpp"

#include <stdexcept>

namespace rclcpp {

std::chrono::nanoseconds Rate::period_of(double rate) {
  if (!(rate > 0.0)) throw std::invalid_argument("a rate must be above 0 Hz");
  return Duration::from_seconds(1.0 / rate).to_chrono<std::chrono::nanoseconds>();
}

Rate::Rate(double rate) : Rate(period_of(rate)) {}
Rate::Rate(std::chrono::nanoseconds period)
    : Rate(period, std::make_shared<Clock>(RCL_SYSTEM_TIME)) {}
Rate::Rate(std::chrono::nanoseconds period, Clock::SharedPtr clock)
    : clock_(std::move(clock)), period_(period), last_(clock_->now()) {
  if (period.count() <= 0) throw std::invalid_argument("a period must be above 0 s");
}

bool Rate::sleep() {
  const auto now = clock_->now();
  const auto next = last_ + period_;
  // Time went back, or more than a whole period was missed: restart.
  if (now < last_ || now > next + period_) {
    last_ = now;
    return false;
  }
  last_ = next;
  return now < next && clock_->sleep_until(next);
}

void Rate::reset() {
  last_ = clock_->now();
}

}  // namespace rclcpp
