// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rosflight::core {
namespace {

constexpr float kPi = 3.14159265f;

hal::ImuSample sample(hal::Time stamp, float rate, float acceleration) {
  return {stamp, {acceleration, 0.5f, -9.8f}, {rate, 0.0f, 1.0f}, 300.0f};
}

TEST(ImuMean, SlowSamplesPassAsTheyAre) {
  for (const int period_us : {2500, 1000, 800}) {
    ImuMean mean;
    for (int k = 1; k < 50; ++k) {
      hal::ImuSample s = sample(hal::Time{k * period_us}, 0.1f * static_cast<float>(k), 3.0f);
      float dt_s = 1e-6f * static_cast<float>(period_us);
      ASSERT_TRUE(mean.step(s, dt_s));
      EXPECT_EQ(s.stamp, hal::Time{k * period_us});
      EXPECT_EQ(s.gyro_rad_s[0], 0.1f * static_cast<float>(k));
      EXPECT_EQ(dt_s, 1e-6f * static_cast<float>(period_us));
    }
  }
}

TEST(ImuMean, TwoOfTwoKilohertzAreOneWithTheMeanOfTheirStamps) {
  ImuMean mean;
  int means = 0;
  for (int k = 0; k < 100; ++k) {
    const auto x = static_cast<float>(k);
    hal::ImuSample s = sample(hal::Time{7 + 500 * k}, x, -2.0f * x);
    float dt_s = 5e-4f;
    ASSERT_EQ(mean.step(s, dt_s), k % 2 == 1);
    if (k % 2 == 0) continue;
    ++means;
    EXPECT_EQ(s.stamp, hal::Time{7 + 500 * k - 250});
    EXPECT_FLOAT_EQ(s.gyro_rad_s[0], x - 0.5f);
    EXPECT_FLOAT_EQ(s.gyro_rad_s[2], 1.0f);
    EXPECT_FLOAT_EQ(s.accel_m_s2[0], -2.0f * x + 1.0f);
    EXPECT_FLOAT_EQ(s.accel_m_s2[2], -9.8f);
    EXPECT_FLOAT_EQ(dt_s, 1e-3f);
  }
  EXPECT_EQ(means, 50);
}

TEST(ImuMean, WhatWouldComeBackAsASlowMotionIsHeldBack) {
  // 980 Hz, sampled at 2 kHz: every second sample would show it as 20 Hz at full size.
  ImuMean mean;
  float largest = 0.0f, largest_of_every_second = 0.0f;
  for (int k = 0; k < 2000; ++k) {
    const float rate = std::sin(2.0f * kPi * 980.0f * 5e-4f * static_cast<float>(k));
    hal::ImuSample s = sample(hal::Time{500 * k}, rate, 0.0f);
    float dt_s = 5e-4f;
    if (k % 2 == 1) largest_of_every_second = std::max(largest_of_every_second, std::abs(rate));
    if (mean.step(s, dt_s)) largest = std::max(largest, std::abs(s.gyro_rad_s[0]));
  }
  EXPECT_GT(largest_of_every_second, 0.99f);
  // |cos(pi f / 2 kHz)|
  EXPECT_NEAR(largest, std::cos(kPi * 980.0f / 2000.0f), 0.003f);
}

TEST(ImuMean, WhatWaitsIsDroppedWhenTheClockIsSet) {
  ImuMean mean;
  hal::ImuSample s = sample(hal::Time{500}, 5.0f, 5.0f);
  float dt_s = 5e-4f;
  ASSERT_FALSE(mean.step(s, dt_s));
  s = sample(hal::Time{9'000'000}, 1.0f, 1.0f);
  dt_s = 0.0f;
  ASSERT_TRUE(mean.step(s, dt_s));
  EXPECT_EQ(s.gyro_rad_s[0], 1.0f);
  s = sample(hal::Time{9'000'500}, 2.0f, 2.0f);
  dt_s = 5e-4f;
  ASSERT_FALSE(mean.step(s, dt_s));
  s = sample(hal::Time{9'001'000}, 4.0f, 4.0f);
  dt_s = 5e-4f;
  ASSERT_TRUE(mean.step(s, dt_s));
  EXPECT_FLOAT_EQ(s.gyro_rad_s[0], 3.0f);
  EXPECT_EQ(s.stamp, hal::Time{9'000'750});
}

}  // namespace
}  // namespace rosflight::core
