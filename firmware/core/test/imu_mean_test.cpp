// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/imu_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "firmware/core/test/sensors_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kPi = 3.14159265f;

hal::ImuSample sample(hal::Time stamp, float rate, float acceleration) {
  return {stamp, {acceleration, 0.5f, -9.8f}, {rate, 0.0f, 1.0f}, 300.0f};
}

/// One sample of a pass.
bool step(ImuMean& mean, hal::ImuSample& sample, float& dt_s) {
  mean.add(sample, dt_s);
  return mean.take(sample, dt_s);
}

TEST(ImuMean, SlowSamplesPassAsTheyAre) {
  for (const int period_us : {2500, 1000, 800}) {
    ImuMean mean;
    for (int k = 1; k < 50; ++k) {
      hal::ImuSample s = sample(hal::Time{k * period_us}, 0.1f * static_cast<float>(k), 3.0f);
      float dt_s = 1e-6f * static_cast<float>(period_us);
      ASSERT_TRUE(step(mean, s, dt_s));
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
    ASSERT_EQ(step(mean, s, dt_s), k % 2 == 1);
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
    if (step(mean, s, dt_s)) largest = std::max(largest, std::abs(s.gyro_rad_s[0]));
  }
  EXPECT_GT(largest_of_every_second, 0.99f);
  // |cos(pi f / 2 kHz)|
  EXPECT_NEAR(largest, std::cos(kPi * 980.0f / 2000.0f), 0.003f);
}

TEST(ImuMean, WhatWaitsIsDroppedWhenTheClockIsSet) {
  ImuMean mean;
  hal::ImuSample s = sample(hal::Time{500}, 5.0f, 5.0f);
  float dt_s = 5e-4f;
  ASSERT_FALSE(step(mean, s, dt_s));
  s = sample(hal::Time{9'000'000}, 1.0f, 1.0f);
  dt_s = 0.0f;
  ASSERT_TRUE(step(mean, s, dt_s));
  EXPECT_EQ(s.gyro_rad_s[0], 1.0f);
  s = sample(hal::Time{9'000'500}, 2.0f, 2.0f);
  dt_s = 5e-4f;
  ASSERT_FALSE(step(mean, s, dt_s));
  s = sample(hal::Time{9'001'000}, 4.0f, 4.0f);
  dt_s = 5e-4f;
  ASSERT_TRUE(step(mean, s, dt_s));
  EXPECT_FLOAT_EQ(s.gyro_rad_s[0], 3.0f);
  EXPECT_EQ(s.stamp, hal::Time{9'000'750});
}

TEST(ImuMean, AllThatWaitMakeOneStep) {
  ImuMean mean;
  hal::ImuSample s{};
  float dt_s = 0.0f;
  EXPECT_FALSE(mean.take(s, dt_s)) << "nothing came";
  for (const int k : {1, 2, 3}) {
    const auto x = static_cast<float>(k);
    s = sample(hal::Time{500 * k}, x, 2.0f * x);
    dt_s = 5e-4f;
    mean.add(s, dt_s);
  }
  ASSERT_TRUE(mean.take(s, dt_s));
  EXPECT_EQ(s.stamp, hal::Time{1000});
  EXPECT_FLOAT_EQ(s.gyro_rad_s[0], 2.0f);
  EXPECT_FLOAT_EQ(s.accel_m_s2[0], 4.0f);
  EXPECT_FLOAT_EQ(dt_s, 1.5e-3f);
  EXPECT_FALSE(mean.take(s, dt_s)) << "it was taken";
}

TEST(ImuMean, NoTimeIsLostOrCountedTwiceHoweverSamplesArrive) {
  std::mt19937 random{1};
  ImuMean mean;
  hal::Time stamp{0}, taken{0};
  for (int pass = 0; pass < 20'000; ++pass) {
    hal::ImuSample s{};
    float dt_s = 0.0f;
    double added_s = 0.0;
    for (int left = static_cast<int>(random() % 4); left > 0; --left) {
      const auto step_us = static_cast<std::int64_t>(100 + random() % 2000);
      stamp += hal::Time{step_us};
      s = sample(stamp, 1.0f, 2.0f);
      mean.add(s, dt_s = 1e-6f * static_cast<float>(step_us));
      added_s += static_cast<double>(dt_s);
    }
    if (!mean.take(s, dt_s)) {
      ASSERT_LT(hal::seconds(stamp - taken), hal::kShortestImuStep_s);
      continue;
    }
    ASSERT_NEAR(dt_s, hal::seconds(stamp - taken), 1e-6f);
    ASSERT_GE(static_cast<double>(dt_s), added_s - 1e-9);
    ASSERT_GT(s.stamp, taken);
    ASSERT_LE(s.stamp, stamp);
    ASSERT_FLOAT_EQ(s.gyro_rad_s[0], 1.0f);
    taken = stamp;
  }
}

// ---- in the sensors

/// Samples that wait, one for each poll.
struct Waiting final : hal::Source<hal::ImuSample> {
  bool poll(hal::ImuSample& sample) override {
    ++polls;
    if (samples.empty()) return false;
    sample = samples.front();
    if (!endless) samples.pop_front();
    sample.stamp += hal::Time{endless ? 500 * polls : 0};
    return true;
  }
  std::deque<hal::ImuSample> samples;
  int polls{0};
  bool endless{false};
};

class WaitingSamples : public SensorsTest {
 protected:
  void put(int count, const hal::Vec3& gyro = {0.1f, 0.0f, 0.0f}) {
    for (; count > 0; --count) {
      stamp_ += hal::Time{500};
      waiting_.samples.push_back(
          {stamp_, {0.0f, 0.0f, ++number_ % 2 == 0 ? -9.8f : -9.81f}, gyro, 300.0f});
    }
  }
  void pass() { sensors_.step(stamp_, here_, parameters_, log_); }

  Waiting waiting_;
  hal::Board here_{roles_.clock,         roles_.system, roles_.serial,  roles_.storage,
                   roles_.backup,        roles_.leds,   roles_.outputs, roles_.receiver,
                   roles_.battery,       waiting_,      roles_.mag,     roles_.baro,
                   roles_.diff_pressure, roles_.range,  roles_.gnss};
  hal::Time stamp_{hal::milliseconds(1000)};
  int number_{0};
};

TEST_F(WaitingSamples, APassThatComesLateLeavesNoneBehind) {
  put(1);
  pass();
  ASSERT_TRUE(now().new_imu) << "the first shows no rate yet";
  for (const int count : {2, 3, 4, 2}) {
    put(count);
    pass();
    ASSERT_TRUE(now().new_imu);
    EXPECT_EQ(now().imu.stamp, stamp_ - hal::Time{250 * (count - 1)});
    EXPECT_TRUE(waiting_.samples.empty());
  }
}

TEST_F(WaitingSamples, OneAloneIsKeptForTheNextPass) {
  put(1);
  pass();
  put(1);
  pass();
  EXPECT_FALSE(now().new_imu);
  put(1);
  pass();
  EXPECT_TRUE(now().new_imu);
  EXPECT_EQ(now().imu.stamp, stamp_ - hal::Time{250});
}

TEST_F(WaitingSamples, ARefusedOneDoesNotHideTheNext) {
  put(1);
  pass();
  put(1, {NAN, 0.0f, 0.0f});
  put(1);
  pass();
  EXPECT_TRUE(now().new_imu);
  EXPECT_EQ(now().imu.stamp, stamp_);
}

TEST_F(WaitingSamples, ARefusedOneBehindAGoodOneIsNotTaken) {
  put(1);
  pass();
  for (const int good : {2, 3}) {
    put(good);
    put(1, {NAN, 0.0f, 0.0f});
    pass();
    ASSERT_TRUE(now().new_imu);
    EXPECT_FLOAT_EQ(now().imu.gyro_rad_s[0], 0.1f);
  }
  stamp_ += hal::Time{500};
  put(1);  // 1 ms or more behind the last good one, so it makes a step alone
  put(1, {NAN, 0.0f, 0.0f});
  pass();
  ASSERT_TRUE(now().new_imu);
  EXPECT_FLOAT_EQ(now().imu.gyro_rad_s[0], 0.1f);
}

TEST_F(WaitingSamples, ASourceWithoutEndDoesNotKeepThePass) {
  put(1);
  waiting_.endless = true;
  pass();
  EXPECT_EQ(waiting_.polls, 4);
}

}  // namespace
}  // namespace rosflight::core
