// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/rate.hpp"

#include <stdexcept>

namespace rclcpp {

namespace {
Duration period_of(double rate) {
  if (!(rate > 0.0)) throw std::invalid_argument("a rate must be above 0 Hz");
  return Duration::from_seconds(1.0 / rate);
}
}  // namespace

Rate::Rate(double rate, Clock::SharedPtr clock) : Rate(period_of(rate), std::move(clock)) {}

Rate::Rate(const Duration& period, Clock::SharedPtr clock)
    : clock_(std::move(clock)), period_(period), last_(clock_->now()) {
  if (period_.nanoseconds() <= 0) throw std::invalid_argument("a period must be above 0 s");
}

bool Rate::sleep() {
  const auto now = clock_->now();
  const auto next = last_ + period_;
  // Time went back, or more than a whole period was missed: start anew.
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
