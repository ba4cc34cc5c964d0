// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_mean.hpp"

namespace rosflight::core {

bool ImuMean::add(hal::ImuSample& sample, float& dt_s) {
  if (count_++ == 0) {
    first_ = sample;
    accel_ = gyro_ = {};
    late_us_ = 0;
    covered_s_ = 0.0f;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    accel_[k] += sample.accel_m_s2[k] - first_.accel_m_s2[k];
    gyro_[k] += sample.gyro_rad_s[k] - first_.gyro_rad_s[k];
  }
  late_us_ += static_cast<std::int32_t>((sample.stamp - first_.stamp).count());
  covered_s_ += dt_s;
  if (covered_s_ < kShortest_s) return false;
  const float share = 1.0f / static_cast<float>(count_);
  for (std::size_t k = 0; k < 3; ++k) {
    sample.accel_m_s2[k] = first_.accel_m_s2[k] + share * accel_[k];
    sample.gyro_rad_s[k] = first_.gyro_rad_s[k] + share * gyro_[k];
  }
  sample.stamp = first_.stamp + hal::Time{late_us_ / count_};
  dt_s = covered_s_;
  count_ = 0;
  return true;
}

}  // namespace rosflight::core
