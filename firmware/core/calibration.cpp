// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/calibration.hpp"

namespace rosflight::core {

PressureCalibration::Result PressureCalibration::add(Time now, float pressure_Pa) {
  if (step_ > 0 && now - last_ <= kSpacing) return Result::kRunning;
  last_ = now;
  ++step_;
  if (step_ <= kSettle) return Result::kRunning;
  const int n = step_ - kSettle;
  if (n <= kAverage) {
    const float delta = pressure_Pa - mean_;
    mean_ += delta / static_cast<float>(n);
    squares_ += delta * (pressure_Pa - mean_);
    return Result::kRunning;
  }
  const float variance = squares_ / static_cast<float>(kAverage - 1);
  if (variance < max_variance_) {
    running_ = false;
    return Result::kGood;
  }
  start();
  return Result::kUnsteady;
}

}  // namespace rosflight::core
