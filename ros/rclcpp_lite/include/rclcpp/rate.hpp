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
  explicit Rate(double rate, Clock::SharedPtr clock = std::make_shared<Clock>(RCL_SYSTEM_TIME));
  explicit Rate(const Duration& period,
                Clock::SharedPtr clock = std::make_shared<Clock>(RCL_SYSTEM_TIME));
  /// Sleeps to the end of the period. False: it was over already, or the context is shut down.
  bool sleep() override;
  void reset() override;

 private:
  Clock::SharedPtr clock_;
  Duration period_;
  Time last_;
};

/// A rate on steady time.
class WallRate : public Rate {
 public:
  RCLCPP_SMART_PTR_DEFINITIONS(WallRate)
  explicit WallRate(double rate) : Rate(rate, std::make_shared<Clock>(RCL_STEADY_TIME)) {}
  explicit WallRate(const Duration& period)
      : Rate(period, std::make_shared<Clock>(RCL_STEADY_TIME)) {}
};

}  // namespace rclcpp
