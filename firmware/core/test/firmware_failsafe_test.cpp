// SPDX-License-Identifier: BSD-3-Clause
// Loss of the radio, of the companion and of the IMU.
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kAlmost = 1e-4f;  // the attitude estimate of a vehicle at rest is good to 1e-4 rad

class FirmwareFailsafe : public testing::Test {
 protected:
  void fly_quadrotor() {
    rig_.store_quadrotor();
    rig_.start();
    rig_.arm();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(100);
    ASSERT_EQ(rig_.errors(), 0);
  }
  void expect_motors(float value, float tolerance = kAlmost) {
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(rig_.outputs()[k], value, tolerance) << k;
  }
  bool failsafe() const { return rig_.firmware().state().failsafe(); }

  FirmwareRig rig_;
};

// ---- radio

TEST_F(FirmwareFailsafe, RadioLostWhileDisarmedIsAnErrorAndNoFailsafe) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(500);
  rig_.rc.failsafe = true;
  rig_.run_for(50);
  EXPECT_EQ(rig_.errors(), 0x04);
  EXPECT_FALSE(failsafe());
  EXPECT_EQ(rig_.firmware().state().state(), State::kError);
  rig_.rc.failsafe = false;
  rig_.run_for(50);
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_EQ(rig_.firmware().state().state(), State::kPreflight);
}

TEST_F(FirmwareFailsafe, RadioLostWhileArmedLevelsWithTheFailsafeThrottleAndComesBack) {
  fly_quadrotor();
  rig_.rc.channels[FirmwareRig::kRoll] = 0.9f;
  rig_.run_for(100);
  EXPECT_GT(std::abs(rig_.outputs()[0] - rig_.outputs()[2]), 0.05f) << "rolling";
  rig_.inbox.clear();
  rig_.rc.failsafe = true;
  rig_.run_for(30);
  EXPECT_TRUE(failsafe());
  EXPECT_TRUE(rig_.armed());
  expect_motors(0.28f);  // FAILSAFE_THR 0.4 x RC_MAX_THR 0.7 (reference run)
  const auto status = rig_.got<link::Status>();
  ASSERT_FALSE(status.empty());
  EXPECT_TRUE(status.back().failsafe);
  EXPECT_TRUE(status.back().armed);
  EXPECT_EQ(status.back().error_code, 0x04);
  rig_.rc.failsafe = false;
  rig_.run_for(30);
  EXPECT_FALSE(failsafe());
  EXPECT_TRUE(rig_.armed());
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_GT(std::abs(rig_.outputs()[0] - rig_.outputs()[2]), 0.05f) << "the pilot's again";
}

// Weak point 2: five seconds of silence left the outputs as they were.
TEST_F(FirmwareFailsafe, ASilentReceiverIsLossAfterTwoTenthsOfASecond) {
  fly_quadrotor();
  rig_.rc_on = false;
  const std::int64_t took = rig_.ms_until([this] { return failsafe(); }, 1000);
  EXPECT_GE(took, 180);  // the last frame came up to 20 ms before
  EXPECT_LE(took, 203);
  rig_.run_for(5);
  expect_motors(0.28f);
}

// Weak point 3.
TEST_F(FirmwareFailsafe, OneLostFrameIsNoFailsafeATenthOfASecondOfThemIs) {
  fly_quadrotor();
  rig_.rc.frame_lost = true;
  rig_.run_for(60);
  EXPECT_FALSE(failsafe());
  rig_.rc.frame_lost = false;
  rig_.run_for(60);
  EXPECT_FALSE(failsafe());
  rig_.rc.frame_lost = true;
  const std::int64_t took = rig_.ms_until([this] { return failsafe(); }, 1000);
  EXPECT_GE(took, 80);  // the last good frame came up to 20 ms before
  EXPECT_LE(took, 123);
}

TEST_F(FirmwareFailsafe, AnAirplaneFailsafeIsNeutralServosAndNoThrottle) {
  rig_.store_airplane();
  rig_.start();
  rig_.arm();
  rig_.rc.channels = {0.9f, 0.9f, 0.7f, 0.9f};
  rig_.run_for(100);
  rig_.rc.failsafe = true;
  rig_.run_for(30);
  EXPECT_TRUE(failsafe());
  for (std::size_t k = 0; k < 10; ++k) {
    const OutputType type = rig_.firmware().mixer().header().type[k];
    if (type == OutputType::kServo) {
      EXPECT_NEAR(rig_.outputs()[k], 0.5f, kAlmost) << k;
    }
    if (type == OutputType::kMotor) {
      EXPECT_NEAR(rig_.outputs()[k], 0.1f, kAlmost) << k << ": idle";
    }
  }
}

// Weak point 4: an identity secondary mixer got the failsafe command; motors went to idle.
TEST_F(FirmwareFailsafe, FailsafeUsesThePrimaryMixerWhenTheCompanionHadControl) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_int(Param::kSecondaryMixer, 11));
    for (std::uint16_t k = 0; k < 10; ++k) {
      const auto id = static_cast<Param>(static_cast<std::uint16_t>(Param::kSecMixer0_0) + 11 * k);
      static_cast<void>(p.set_float(id, 1.0f));
    }
  });
  rig_.start();
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 1.0f;
  rig_.offboard =
      link::OffboardControl{0, 0, {0.31f, 0.32f, 0.33f, 0.34f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}};
  rig_.run_for(100);
  ASSERT_EQ(rig_.firmware().command().override_word(), 0);
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_NEAR(rig_.outputs()[k], 0.31f + 0.01f * static_cast<float>(k), kAlmost)
        << "the companion drives the motors directly";
  }
  rig_.rc.failsafe = true;
  rig_.run_for(30);
  expect_motors(0.28f);
  rig_.rc.failsafe = false;
  rig_.run_for(30);
  EXPECT_NEAR(rig_.outputs()[3], 0.34f, kAlmost);
}

// Weak point 5.
TEST_F(FirmwareFailsafe, FixedWingOnAndOffAgainLeavesAMultirotorFailsafe) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(200);
  rig_.set_param("FIXED_WING", 1);
  rig_.run_for(20);
  rig_.set_param("FIXED_WING", 0);
  rig_.run_for(20);
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.rc.failsafe = true;
  rig_.run_for(150);
  expect_motors(0.28f);
}

// ---- companion

TEST_F(FirmwareFailsafe, ASilentCompanionHandsOverToThePilotAfterItsTimeOut) {
  fly_quadrotor();
  rig_.offboard = link::OffboardControl{2, 0, {0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0}};
  rig_.run_for(100);
  EXPECT_EQ(rig_.firmware().command().override_word(), 0);
  expect_motors(0.35f);
  EXPECT_TRUE(rig_.got<link::Status>().back().offboard);
  rig_.offboard.reset();
  // No frame at the moment of the time-out: it counts all the same (weak point 1).
  const std::int64_t took =
      rig_.ms_until([this] { return rig_.firmware().command().override_word() == 0x3C0; }, 500);
  EXPECT_GE(took, 100);
  EXPECT_LE(took, 103);
  rig_.run_for(5);
  expect_motors(0.56f);
  EXPECT_FALSE(rig_.got<link::Status>().back().offboard);
}

// Weak point 1: with receiver frames every 20 ms the reference took a command in up to 20 ms later.
TEST_F(FirmwareFailsafe, EveryOffboardCommandIsInForceOnTheNextImuSample) {
  fly_quadrotor();
  for (int k = 0; k < 40; ++k) {
    const float throttle = 0.3f + 0.01f * static_cast<float>(k % 10);
    rig_.offboard = link::OffboardControl{2, 0, {0, 0, throttle, 0, 0, 0, 0, 0, 0, 0}};
    rig_.pass();
    rig_.offboard.reset();
    rig_.pass();
    expect_motors(0.7f * throttle);
  }
}

// Weak point 12: F_z = -0.6 in pass-through, stick down, TAKE_MIN_THR 1: motors stayed at 0.6.
TEST_F(FirmwareFailsafe, LoweringTheStickCutsThePowerOfAPassThroughCompanion) {
  fly_quadrotor();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.9f;
  rig_.offboard = link::OffboardControl{0, 0, {0, 0, -0.6f, 0, 0, 0, 0, 0, 0, 0}};
  rig_.run_for(100);
  expect_motors(0.6f);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig_.run_for(50);
  EXPECT_EQ(rig_.firmware().command().override_word(), 0x20);
  expect_motors(0.1f);  // idle
}

// ---- IMU (weak point 25: outputs were left as they were, without an error)

TEST_F(FirmwareFailsafe, AMultirotorWithoutImuStopsItsMotorsAndFliesOnWhenItAnswers) {
  fly_quadrotor();
  rig_.imu_on = false;
  rig_.run_for(95);
  expect_motors(0.56f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x02);
  expect_motors(0.0f, 0.0f);
  EXPECT_TRUE(rig_.armed());
  EXPECT_TRUE(rig_.said("IMU not responding"));
  rig_.imu_on = true;
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0);
  expect_motors(0.56f, 1e-3f);
}

TEST_F(FirmwareFailsafe, AnAirplaneWithoutImuFliesOnTheSticks) {
  rig_.store_airplane();
  rig_.start();
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.6f;
  rig_.run_for(100);
  rig_.imu_on = false;
  rig_.run_for(150);
  EXPECT_EQ(rig_.errors(), 0x02);
  const auto before = rig_.outputs();
  rig_.rc.channels[FirmwareRig::kRoll] = 0.9f;
  rig_.run_for(50);
  EXPECT_GT(std::abs(rig_.outputs()[0] - before[0]), 0.1f) << "aileron follows";
  // Without radio as well: the failsafe command, not the last sticks.
  rig_.rc.failsafe = true;
  rig_.run_for(60);
  ASSERT_TRUE(failsafe());
  EXPECT_NEAR(rig_.outputs()[0], 0.5f, kAlmost);
}

TEST_F(FirmwareFailsafe, AnImuThatNeverAnswersIsTold) {
  rig_.store_quadrotor();
  rig_.imu_on = false;
  rig_.start();
  rig_.run_for(95);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x02);
}

TEST_F(FirmwareFailsafe, TimeGoingBackwardsSkipsOneControlStepAndIsCleared) {
  fly_quadrotor();
  const auto writes = rig_.board.outputs.writes();
  rig_.imu_offset = hal::milliseconds(-50);
  rig_.pass();
  EXPECT_EQ(rig_.errors(), 0x10);
  EXPECT_TRUE(rig_.armed()) << "errors never disarm";
  EXPECT_EQ(rig_.board.outputs.writes(), writes);
  rig_.pass();
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_EQ(rig_.board.outputs.writes(), writes + 1);
}

TEST_F(FirmwareFailsafe, EqualStampsAreNoErrorAndEveryNumberStaysFinite) {  // weak point 38
  fly_quadrotor();
  rig_.imu_drift = hal::microseconds(-FirmwareRig::kPass_us);
  rig_.run_for(100);
  EXPECT_EQ(rig_.errors(), 0);
  expect_motors(0.56f, 1e-3f);
}

// Weak point 24: a gap was integrated with one sample.
TEST_F(FirmwareFailsafe, AGapInTheImuDataDoesNotTurnTheAttitude) {
  fly_quadrotor();
  rig_.run_for(3000);
  rig_.gyro_rad_s = {3.0f, 0.0f, 0.0f};
  rig_.imu_on = false;
  rig_.run_for(400);
  rig_.imu_on = true;
  rig_.pass();
  EXPECT_NEAR(rig_.firmware().estimator().estimate().roll_rad, 0.0f, 0.02f)
      << "0.4 s at 3 rad/s would be 1.2 rad";
}

}  // namespace
}  // namespace rosflight::core
