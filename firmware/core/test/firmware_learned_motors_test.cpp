// SPDX-License-Identifier: BSD-3-Clause
// The firmware of a build with a policy of motors. That of this test gives each motor the commanded throttle and a share of its
// own, and roll by its sign on the motors of the left: beyond half a radian of it an output is out of range.
#include <random>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kMaxRoll = 0.786f;  // RC_MAX_ROLL

Policy::Outputs by_throttle(Policy::States& /*states*/, const Policy::Inputs& x) {
  const float middle = 2.0f * x[13] - 1.0f;
  return {middle - x[6], middle + 0.01f, middle + 0.02f, middle + x[6]};
}
constexpr Policy kByThrottle{"by_throttle.onnx", 0.0f, by_throttle, Policy::Kind::kMotorOutputs};

}  // namespace

const Policy* built_in_policy() {
  return &kByThrottle;
}

namespace {

class FirmwareLearnedMotors : public testing::Test {
 protected:
  void fly(float throttle = 0.6f) {
    rig_.store_quadrotor();
    rig_.start();
    take_off(throttle);
  }
  void take_off(float throttle) {
    rig_.arm();
    this->throttle(throttle);
    rig_.run_for(100);
  }
  void throttle(float stick) { rig_.rc.channels[FirmwareRig::kThrottle] = stick; }
  void roll(float stick) { rig_.rc.channels[FirmwareRig::kRoll] = 0.5f + 0.5f * stick; }
  const LearnedController& learned() const { return rig_.firmware().learned(); }
  /// What the loops make of the sticks level and at rest: throttle x RC_MAX_THR on all motors.
  void expect_by_loops(float stick) {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(rig_.outputs()[k], 0.7f * stick, 5e-3f) << k;
  }
  void expect_at_idle() {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(rig_.outputs()[k], 0.1f, 1e-6f) << k;
  }

  FirmwareRig rig_;
};

TEST_F(FirmwareLearnedMotors, CommandsTheMotors) {
  fly(0.6f);
  ASSERT_TRUE(learned().flying());
  EXPECT_NEAR(rig_.outputs()[0], 0.6f, 1e-3f);
  EXPECT_NEAR(rig_.outputs()[1], 0.605f, 1e-3f);
  EXPECT_NEAR(rig_.outputs()[2], 0.61f, 1e-3f);
  roll(0.4f);
  rig_.run_for(100);
  EXPECT_NEAR(rig_.outputs()[0], 0.6f - 0.5f * 0.4f * kMaxRoll, 1e-3f);
  EXPECT_NEAR(rig_.outputs()[3], 0.6f + 0.5f * 0.4f * kMaxRoll, 1e-3f);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareLearnedMotors, MotorsStandStillDisarmedAndIdleBelowTheIdleThrottle) {
  rig_.store_quadrotor();
  rig_.start();
  throttle(0.6f);
  rig_.run_for(200);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(rig_.outputs()[k], 0.0f) << k << ": disarmed";
  throttle(0.0f);
  rig_.run_for(2000);
  take_off(0.0f);
  EXPECT_FALSE(learned().flying());
  expect_at_idle();
  throttle(0.5f);
  rig_.run_for(100);
  EXPECT_TRUE(learned().flying());
  throttle(0.13f);  // x 0.7 is less than idle
  rig_.run_for(100);
  EXPECT_FALSE(learned().flying());
  expect_at_idle();
  EXPECT_EQ(learned().end(), LearnedController::End::kNone) << "nothing was missed";
}

TEST_F(FirmwareLearnedMotors, AnOutputOutOfRangeGivesTheSamePassToTheLoops) {
  fly(0.8f);
  while (learned().flying()) {
    roll(0.6f);
    rig_.pass();
  }
  EXPECT_EQ(learned().end(), LearnedController::End::kOutput);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(rig_.outputs()[k], 0.56f, 0.12f)
        << k << ": in the pass that ended it, with roll by the loop";
  }
  roll(0.0f);
  rig_.run_for(1000);
  EXPECT_FALSE(learned().flying()) << "latched";
  expect_by_loops(0.8f);
  EXPECT_EQ(rig_.count_text("Learned control off until disarm: output 1.07"), 1u);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(FirmwareLearnedMotors, TheFailsafeAndTiltAreFlownByTheLoops) {
  fly(0.6f);
  rig_.rc.failsafe = true;
  rig_.run_for(60);
  EXPECT_FALSE(learned().flying());
  expect_by_loops(0.4f);  // FAILSAFE_THR
  rig_.rc.failsafe = false;
  rig_.run_for(60);
  EXPECT_TRUE(learned().flying());
  rig_.gyro_rad_s[0] = 3.0f;
  ASSERT_GE(rig_.ms_until([this] { return !learned().flying(); }, 1500), 400);
  EXPECT_EQ(learned().end(), LearnedController::End::kTilt);
}

TEST_F(FirmwareLearnedMotors, AnotherNumberOfMotorsIsFlownByTheLoops) {
  rig_.store([](Parameters& p) {
    ASSERT_EQ(p.set_int(Param::kPrimaryMixer, 4), SetResult::kChanged);  // hexarotor
    ASSERT_EQ(p.set_float(Param::kFailsafeThr, 0.4f), SetResult::kChanged);
    ASSERT_EQ(p.set_float(Param::kAccXBias, 1e-6f), SetResult::kChanged);
    ASSERT_EQ(p.set_float(Param::kGyroXBias, 1e-6f), SetResult::kChanged);
  });
  rig_.start();
  rig_.run_for(200);
  EXPECT_TRUE(rig_.said("Learned controller off: needs 4 motors"));
  take_off(0.6f);
  EXPECT_EQ(rig_.firmware().mixer().motor_count(), 6u);
  EXPECT_FALSE(learned().flying());
  expect_by_loops(0.6f);
}

/// Sticks, throttle, attitude and radio at random, from one arming to the next disarming: what holds in every pass.
TEST_F(FirmwareLearnedMotors, RandomFlightsKeepTheRules) {
  rig_.store_quadrotor();
  rig_.start();
  std::mt19937 random{8};
  std::uniform_real_distribution<float> share{-1.0f, 1.0f};
  int flown = 0;
  int endings = 0;
  for (int flight = 0; flight < 20; ++flight) {
    rig_.run_for(15'000);  // the attitude settles
    rig_.hold_arming_corner();
    ASSERT_GE(rig_.ms_until([this] { return rig_.armed(); }, 5000), 0) << flight;
    rig_.release();
    bool ended = false;
    for (int k = 0; k < 800; ++k) {
      if (k % 80 == 0) {
        throttle(0.5f + 0.45f * share(random));
        roll(share(random));
        rig_.rc.failsafe = share(random) > 0.9f;
        rig_.gyro_rad_s[0] = share(random) > 0.8f ? 4.0f * share(random) : 1e-6f;
      }
      rig_.pass();
      const bool has_ended = learned().end() != LearnedController::End::kNone;
      ASSERT_TRUE(has_ended || !ended || !rig_.armed()) << "latched while armed";
      endings += has_ended && !ended ? 1 : 0;
      ended = has_ended;
      flown += learned().flying() ? 1 : 0;
      ASSERT_TRUE(!learned().flying() || (!has_ended && rig_.armed())) << k;
      for (std::size_t motor = 0; motor < 4; ++motor) {
        const float value = rig_.outputs()[motor];
        ASSERT_TRUE(rig_.armed() ? value >= 0.1f && value <= 1.0f : value == 0.0f) << k;
      }
    }
    roll(0.0f);
    rig_.rc.failsafe = false;
    rig_.gyro_rad_s[0] = 1e-6f;
    throttle(0.0f);
    rig_.rc.channels[FirmwareRig::kYaw] = 0.0f;
    ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 5000), 0) << flight;
    ASSERT_EQ(learned().end(), LearnedController::End::kNone);
    rig_.release();
  }
  EXPECT_GT(endings, 5);
  EXPECT_GT(flown, 2000);
}

}  // namespace
}  // namespace rosflight::core
