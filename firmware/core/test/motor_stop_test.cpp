// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/motor_stop.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "firmware/core/test/random.hpp"

namespace rosflight::core {
namespace {

constexpr Time kStep = hal::microseconds(2500);
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class MotorStopTest : public testing::Test {
 protected:
  void run_for(std::int64_t ms) {
    const Time end = now_ + hal::milliseconds(ms);
    while (now_ < end) {
      now_ += kStep;
      stop_.step(now_, in_);
    }
  }
  void watch(bool tip_over, bool impact, bool fixed_wing = false) {
    stop_.configure({fixed_wing, tip_over, impact});
  }
  void roll_to(float rad) { in_.q_WB = quaternion_from_euler(rad, 0.0f, 0.0f); }
  static MotorStop::Input at_rest() {
    MotorStop::Input in;
    in.accel_m_s2 = {0.0f, 0.0f, -kGravity_m_s2};
    in.throttle_commanded = true;
    return in;
  }

  MotorStop stop_;
  MotorStop::Input in_{at_rest()};
  Time now_{};
};

TEST_F(MotorStopTest, WithoutParametersOnlyFailsafeIsWatched) {
  EXPECT_FALSE(stop_.watching(false));
  EXPECT_TRUE(stop_.watching(true));
  roll_to(3.0f);
  in_.accel_m_s2 = {0.0f, 0.0f, -200.0f};
  run_for(10'000);
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, HalfASecondBeyondAHundredDegreesStops) {
  watch(true, false);
  EXPECT_TRUE(stop_.watching(false));
  roll_to(99.0f * kRadPerDeg);
  run_for(5000);
  EXPECT_FALSE(stop_.stopped());
  roll_to(101.0f * kRadPerDeg);
  run_for(495);
  EXPECT_FALSE(stop_.stopped());
  run_for(10);
  EXPECT_EQ(stop_.reason(), StopReason::kTipOver);
}

TEST_F(MotorStopTest, AFlipIsNotATipOverAndNeitherIsAVehicleWithoutThrottle) {
  watch(true, false);
  for (int flip = 0; flip < 20; ++flip) {
    roll_to(3.0f);
    run_for(400);
    roll_to(0.0f);
    run_for(50);
  }
  EXPECT_FALSE(stop_.stopped()) << "the half second is without a break";
  in_.throttle_commanded = false;
  roll_to(3.0f);
  run_for(5000);
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, AnImpactAndASecondWithoutMotionStop) {
  watch(false, true);
  in_.accel_m_s2 = {0.0f, 0.0f, -81.0f};
  run_for(5);
  in_ = at_rest();
  in_.rates_rad_s = {3.0f, 0.0f, 0.0f};
  run_for(500);
  EXPECT_FALSE(stop_.stopped());
  in_.rates_rad_s.setZero();
  run_for(980);
  EXPECT_FALSE(stop_.stopped());
  run_for(200);  // the smoothed specific force settles first
  EXPECT_EQ(stop_.reason(), StopReason::kImpact);
}

TEST_F(MotorStopTest, OneSampleIsNoImpact) {
  watch(false, true);
  for (int k = 0; k < 10; ++k) {
    in_.accel_m_s2 = {0.0f, 0.0f, -6900.0f};
    stop_.step(now_ += kStep, in_);
    in_ = at_rest();
    run_for(60);  // two within 50 ms would be one
  }
  run_for(5000);
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, AHardManoeuvreOrALandingLongAgoIsNoImpact) {
  watch(false, true);
  in_.accel_m_s2 = {0.0f, 0.0f, -75.0f};  // 7.6 g
  run_for(100);
  in_ = at_rest();
  run_for(3000);
  EXPECT_FALSE(stop_.stopped());
  in_.accel_m_s2 = {0.0f, 0.0f, -81.0f};
  run_for(5);
  in_ = at_rest();
  in_.rates_rad_s = {0.5f, 0.0f, 0.0f};
  run_for(5100);  // it flies on
  in_.rates_rad_s.setZero();
  run_for(3000);
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, FailsafeAtRestOnTheGroundEndsAfterThirtySecondsAndAProbe) {
  in_.failsafe = true;
  run_for(29'990);
  EXPECT_FALSE(stop_.probing());
  run_for(20);
  EXPECT_TRUE(stop_.probing()) << "held at idle: does it stand?";
  EXPECT_FALSE(stop_.stopped());
  run_for(500);
  EXPECT_EQ(stop_.reason(), StopReason::kFailsafeAtRest);
  EXPECT_FALSE(stop_.probing());
}

/// Mean 0, standard deviation 1: twelve uniform numbers less their mean.
float normal(Random& random) {
  float sum = -6.0f;
  for (int k = 0; k < 12; ++k) sum += random.uniform(0.0f, 1.0f);
  return sum;
}

/// The barometers of the shipped presets have up to 4 Pa of noise, 0.33 m, at 100 Hz.
TEST_F(MotorStopTest, TheNoiseOfABarometerIsNoMotion) {
  constexpr float kMetrePerPascal = 0.0832f;
  for (const float sigma_Pa : {1.0f, 4.0f, 6.0f}) {
    Random random(7);
    stop_.reset();
    in_ = at_rest();
    in_.failsafe = true;
    int k = 0;
    for (; k < 400 * 60 && !stop_.stopped(); ++k) {
      if (k % 4 == 0) in_.altitude_m = 200.0f + sigma_Pa * kMetrePerPascal * normal(random);
      stop_.step(now_ += kStep, in_);
    }
    EXPECT_LE(k, 400 * 36) << sigma_Pa << " Pa";
  }
}

TEST_F(MotorStopTest, ASlowDescentOfAVehicleWithoutOtherMotionIsMotion) {
  in_.failsafe = true;
  for (int k = 0; k < 400 * 120; ++k) {
    in_.altitude_m = 100.0f - 0.1f * static_cast<float>(k) / 400.0f;  // 3 m in 30 s
    stop_.step(now_ += kStep, in_);
    ASSERT_FALSE(stop_.probing()) << k;
  }
}

/// The weight that the rotors carried comes back on the landing gear when the probe begins.
TEST_F(MotorStopTest, LandingGearMaySettleInTheFirstHalfOfTheProbeOnly) {
  for (const std::int64_t begins_ms : {10, 300}) {
    stop_.reset();
    in_ = at_rest();
    in_.failsafe = true;
    while (!stop_.probing()) run_for(2);
    run_for(begins_ms);
    in_.accel_m_s2 = {0.0f, 0.0f, -0.4f * kGravity_m_s2};
    in_.rates_rad_s = {0.3f, 0.0f, 0.0f};
    run_for(20);
    in_ = at_rest();
    in_.failsafe = true;
    run_for(500);
    EXPECT_EQ(stop_.stopped(), begins_ms == 10) << begins_ms;
  }
}

/// A vehicle that hangs on its rotors without a movement looks as if it stood, until the probe.
TEST_F(MotorStopTest, AHoverAsStillAsTheGroundIsNeverStopped) {
  in_.failsafe = true;
  float thrust_g = 1.0f;
  for (int k = 0; k < 400 * 600; ++k) {
    now_ += kStep;
    const float wanted_g = stop_.probing() ? 0.2f : 1.0f;
    thrust_g += (wanted_g - thrust_g) * 0.0025f / 0.1f;  // slow motors: 100 ms
    in_.accel_m_s2 = {0.0f, 0.0f, -kGravity_m_s2 * thrust_g};
    stop_.step(now_, in_);
    ASSERT_FALSE(stop_.stopped()) << hal::to_ms(now_);
    ASSERT_GT(thrust_g, 0.5f) << "the probe ends as soon as thrust is missing";
  }
}

TEST_F(MotorStopTest, ASteadySinkShowsInTheBarometer) {
  in_.failsafe = true;
  for (int k = 0; k < 400 * 120; ++k) {
    now_ += kStep;
    in_.altitude_m = 400.0f - 0.05f * hal::seconds(now_);  // 1.5 m in 30 s
    stop_.step(now_, in_);
    ASSERT_FALSE(stop_.probing()) << hal::to_ms(now_);
  }
}

TEST_F(MotorStopTest, FixedWingsAreNotStoppedInFailsafe) {
  watch(false, false, true);
  in_.failsafe = true;
  run_for(120'000);
  EXPECT_FALSE(stop_.probing());
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, MotionOrTheRadioStartsTheThirtySecondsAnew) {
  for (int k = 0; k < 10; ++k) {
    in_.failsafe = true;
    run_for(29'000);
    in_.failsafe = false;
    run_for(5);
    in_.failsafe = true;
    run_for(20'000);
    in_.rates_rad_s = {0.0f, 0.2f, 0.0f};
    run_for(5);
    in_.rates_rad_s.setZero();
  }
  EXPECT_FALSE(stop_.stopped());
}

TEST_F(MotorStopTest, NumbersThatAreNoneAreMotion) {
  watch(true, true);
  in_.failsafe = true;
  in_.accel_m_s2 = {kNan, 0.0f, 0.0f};
  run_for(60'000);
  EXPECT_FALSE(stop_.stopped());
  in_ = at_rest();
  in_.failsafe = true;
  in_.rates_rad_s = {kNan, 0.0f, 0.0f};
  run_for(60'000);
  EXPECT_FALSE(stop_.stopped());
  in_ = at_rest();
  in_.failsafe = true;
  run_for(31'000);
  EXPECT_TRUE(stop_.stopped()) << "one bad sample does not blind it";
}

TEST_F(MotorStopTest, TheReasonStaysUntilReset) {
  stop_.watch_imu(hal::milliseconds(1000), Time{});
  EXPECT_FALSE(stop_.stopped());
  stop_.watch_imu(hal::milliseconds(1001), Time{});
  EXPECT_EQ(stop_.reason(), StopReason::kImuSilent);
  run_for(60'000);
  EXPECT_EQ(stop_.reason(), StopReason::kImuSilent);
  stop_.reset();
  EXPECT_FALSE(stop_.stopped());
  watch(false, false, true);
  stop_.watch_imu(hal::milliseconds(100'000), Time{});
  EXPECT_FALSE(stop_.stopped()) << "a fixed wing flies on by its sticks";
}

}  // namespace
}  // namespace rosflight::core
