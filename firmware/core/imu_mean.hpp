// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/samples.hpp"

namespace rosflight::core {

/// Takes the mean of samples that come faster than the control loop needs them, as many as cover
/// hal::kShortestImuStep_s: two of a gyro at 2 kHz, and a third that waits already. Slower ones pass as they are.
///
///     mean of n samples: of rate, acceleration and stamp each                               (1)
///
/// Zero at the rate of the means, so a vibration near that does not come back as a slow motion; a filter
/// (GyroChain) has to be in front of it where more is to be kept out. Its delay is in the stamp.
class ImuMean {
 public:
  /// @param dt_s  time since the sample before; not positive when the clock was set or the stamp stands: then what
  ///              came before is dropped.
  void add(const hal::ImuSample& sample, float dt_s) {
    if (count_ == 0 || dt_s <= 0.0f) return begin(sample, dt_s);
    add_to_sums(sample, dt_s);
  }
  /// @param sample  becomes the mean, with the temperature of the first. @param dt_s  becomes the time since the last mean.
  /// @returns false if nothing came or it is too short; then both are untouched.
  bool take(hal::ImuSample& sample, float& dt_s) {
    if (count_ == 0 || (covered_s_ > 0.0f && covered_s_ < hal::kShortestImuStep_s)) return false;
    sample = count_ > 1 ? mean() : first_;
    dt_s = covered_s_;
    count_ = 0;
    return true;
  }

 private:
  void begin(const hal::ImuSample& sample, float dt_s) {
    first_ = sample;
    covered_s_ = dt_s;
    count_ = 1;
  }
  void add_to_sums(const hal::ImuSample& sample, float dt_s);
  hal::ImuSample mean() const;

  hal::ImuSample first_{};
  hal::Vec3 accel_{}, gyro_{};  ///< Sums of what came since, less the first.
  std::int32_t late_us_{0};     ///< Likewise of the stamps.
  float covered_s_{0.0f};
  int count_{0};
};

}  // namespace rosflight::core
