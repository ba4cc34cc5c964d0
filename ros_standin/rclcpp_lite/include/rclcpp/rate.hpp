// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "rclcpp/clock.hpp"

namespace rclcpp {

/// Keeps a loop to a rate; one late pass is not made up for.
class RateBase {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(RateBase)
  virtual ~RateBase() = default;
  virtual bool sleep() = 0;
  virtual void reset() = 0;
};

class Rate : public RateBase {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(Rate)
  /// Throws std::invalid_argument unless the rate [Hz] or the period is positive.
  explicit Rate(double rate);
  explicit Rate(std::chrono::nanoseconds period);
  /// Sleeps to the end of the period. False: it was over already, or the context is shut down.
  bool sleep() override;
  void reset() override;

 protected:
  Rate(std::chrono::nanoseconds period, Clock::SharedPtr clock);
  static std::chrono::nanoseconds period_of(double rate);

 private:
  Clock::SharedPtr clock_;
  Duration period_;
  Time last_;
};

/// A rate on steady time.
class WallRate : public Rate {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(WallRate)
  explicit WallRate(double rate) : WallRate(period_of(rate)) {}
  explicit WallRate(std::chrono::nanoseconds period)
      : Rate(period, std::make_shared<Clock>(RCL_STEADY_TIME)) {}
};

}  // namespace rclcpp
