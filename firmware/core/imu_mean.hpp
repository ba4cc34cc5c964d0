// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/samples.hpp"

namespace rosflight::core {

/// Takes the mean of samples that come faster than the control loop needs them, as many as cover kShortest_s:
/// two of a gyro at 2 kHz. Slower ones pass as they are.
///
///     mean of n samples: of rate, acceleration and stamp each                               (1)
///
/// Zero at the rate of the means, so a vibration near that does not come back as a slow motion; a filter
/// (GyroChain) has to be in front of it where more is to be kept out. Its delay is in the stamp.
class ImuMean {
 public:
  static constexpr float kShortest_s = 8e-4f;

  /// @param dt_s  time since the sample before; in the end since the last mean.
  /// @returns false if the sample is kept for the mean; otherwise `sample` is the mean.
  bool step(hal::ImuSample& sample, float& dt_s) {
    if (dt_s <= 0.0f) count_ = 0;  // the clock was set, or the stamp stands
    if (count_ == 0 && (dt_s >= kShortest_s || dt_s <= 0.0f)) return true;
    return add(sample, dt_s);
  }

 private:
  bool add(hal::ImuSample& sample, float& dt_s);

  hal::ImuSample first_{};
  hal::Vec3 accel_{}, gyro_{};  ///< Sums of what came since, less the first.
  std::int32_t late_us_{0};     ///< Likewise of the stamps.
  float covered_s_{0.0f};
  int count_{0};
};

}  // namespace rosflight::core
