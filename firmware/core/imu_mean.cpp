// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_mean.hpp"

namespace rosflight::core {

void ImuMean::add_to_sums(const hal::ImuSample& sample, float dt_s) {
  if (count_++ == 1) {
    accel_ = gyro_ = {};
    late_us_ = 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    accel_[k] += sample.accel_m_s2[k] - first_.accel_m_s2[k];
    gyro_[k] += sample.gyro_rad_s[k] - first_.gyro_rad_s[k];
  }
  late_us_ += static_cast<std::int32_t>((sample.stamp - first_.stamp).count());
  covered_s_ += dt_s;
}

hal::ImuSample ImuMean::mean() const {
  hal::ImuSample out = first_;
  const float share = 1.0f / static_cast<float>(count_);
  for (std::size_t k = 0; k < 3; ++k) {
    out.accel_m_s2[k] += share * accel_[k];
    out.gyro_rad_s[k] += share * gyro_[k];
  }
  out.stamp += hal::Time{late_us_ / count_};
  return out;
}

}  // namespace rosflight::core
