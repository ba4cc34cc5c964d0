// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/math.hpp"

namespace rosflight::core {

using hal::Time;

/// Mean and spread of IMU samples taken at rest.
class ImuCalibration {
 public:
  static constexpr int kSamples = 1001;

  /// Discards what was collected and begins again.
  void start() {
    *this = ImuCalibration{};
    running_ = true;
  }
  /// Ends without a result.
  void stop() { running_ = false; }
  bool running() const { return running_; }
  /// @returns true with the last sample; the results below are then final and running() is false.
  bool add(const Vector3& value) {
    sum_ += value;
    min_ = min_.cwiseMin(value);
    max_ = max_.cwiseMax(value);
    running_ = ++count_ < kSamples;
    return !running_;
  }
  Vector3 mean() const { return sum_ / static_cast<float>(count_); }
  Vector3 spread() const { return max_ - min_; }

 private:
  Vector3 sum_{Vector3::Zero()};
  Vector3 min_{Vector3::Constant(1e9f)};
  Vector3 max_{Vector3::Constant(-1e9f)};
  int count_{0};
  bool running_{false};
};

/// Mean of a pressure at rest: one step per sample at least 20 ms after the step before; 128 steps
/// settle, 127 are averaged (Welford), and the 256th judges.
class PressureCalibration {
 public:
  enum class Result : std::uint8_t { kRunning, kGood, kUnsteady };

  /// @param max_variance_Pa2  of the samples; above it the calibration fails.
  explicit PressureCalibration(float max_variance_Pa2) : max_variance_{max_variance_Pa2} {}

  /// Discards what was collected and begins again.
  void start() {
    running_ = true;
    step_ = 0;
    mean_ = 0.0f;
    squares_ = 0.0f;
  }
  /// Ends without a result.
  void stop() { running_ = false; }
  bool running() const { return running_; }
  /// After kGood it is no longer running; after kUnsteady it starts over.
  Result add(Time now, float pressure_Pa);
  float mean_Pa() const { return mean_; }

 private:
  static constexpr Time kSpacing = hal::milliseconds(20);
  static constexpr int kSettle = 128;
  static constexpr int kAverage = 127;

  float max_variance_;
  Time last_{};
  int step_{0};
  float mean_{0.0f};
  float squares_{0.0f};
  bool running_{false};
};

}  // namespace rosflight::core
