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

// ---- the receiver is lost and the companion may go on (FAILSAFE_OFFBRD)

TEST_F(FirmwareFailsafe, WithTheChoiceOfTheCompanionALostReceiverChangesNoOutput) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kFailsafeOffbrd, 1)); });
  rig_.start();
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.offboard = link::OffboardControl{2, 0, {0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0}};
  rig_.run_for(1500);
  expect_motors(0.35f);
  rig_.inbox.clear();
  rig_.rc_on = false;
  rig_.run_for(1000);
  EXPECT_TRUE(failsafe()) << "the receiver is lost";
  expect_motors(0.35f);
  const auto status = rig_.got<link::Status>();
  ASSERT_FALSE(status.empty());
  EXPECT_FALSE(status.back().failsafe) << "the failsafe command is not in force";
  EXPECT_TRUE(status.back().offboard);
  EXPECT_EQ(status.back().error_code, 0x04);
  // Without commands the failsafe command follows.
  rig_.offboard.reset();
  rig_.run_for(110);
  expect_motors(0.28f);
  rig_.run_for(10);
  EXPECT_TRUE(rig_.got<link::Status>().back().failsafe);
}

TEST_F(FirmwareFailsafe, AtIdleOnTheGroundALostReceiverStopsTheMotorsWhoeverCommands) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kFailsafeOffbrd, 1)); });
  rig_.start();
  rig_.arm();
  rig_.offboard = link::OffboardControl{2, 0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  rig_.run_for(1500);
  rig_.rc_on = false;
  rig_.run_for(29'000);
  EXPECT_FALSE(rig_.firmware().motor_stop().stopped());
  rig_.run_for(2'000);
  EXPECT_TRUE(rig_.firmware().motor_stop().stopped());
  expect_motors(0.0f, 0.0f);
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
  // No frame at the moment of the timeout: it counts all the same (weak point 1).
  const std::int64_t took =
      rig_.ms_until([this] { return rig_.firmware().command().override_word() == 0x3C0; }, 500);
  EXPECT_GE(took, 100);
  EXPECT_LE(took, 103);
  rig_.run_for(5);
  expect_motors(0.56f);
  EXPECT_FALSE(rig_.got<link::Status>().back().offboard);
}

// Weak point 1: with receiver frames every 20 ms ROSflight 2.x took a command in up to 20 ms later.
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

TEST_F(FirmwareFailsafe, AnAbsurdOffboardValueIsLimitedAndToldOnceASecond) {
  fly_quadrotor();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.9f;
  rig_.inbox.clear();
  rig_.offboard = link::OffboardControl{2, 0, {0, 0, 0.5f, 20.0f, 0, 0, 0, 0, 0, 0}};  // degrees
  rig_.run_for(2000);
  EXPECT_FLOAT_EQ(rig_.firmware().command().combined().value[3], 0.786f);
  const auto told = rig_.count_text("Offboard command limited: axis 3, 20.00 to 0.79");
  EXPECT_GE(told, 2u);
  EXPECT_LE(told, 3u);
  EXPECT_GE(rig_.firmware().command().limited().count, 800u);
  rig_.inbox.clear();
  rig_.offboard = link::OffboardControl{0, 0, {0, 0, -0.4f, 0.2f, 0.1f, 0.3f, 0, 0, 0, 0}};
  rig_.run_for(2000);
  EXPECT_LE(rig_.count_text("Offboard command limited: axis 3, 20.00 to 0.79"), 0u);
  EXPECT_EQ(rig_.firmware().command().combined().value[5], 0.3f);
}

// ---- IMU (weak point 25: outputs were left as they were, without an error)

TEST_F(FirmwareFailsafe, AMultirotorWithoutImuStopsItsMotorsAndFliesOnWhenItAnswers) {
  fly_quadrotor();
  rig_.imu_on = false;
  rig_.run_for(95);
  expect_motors(0.56f);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x02);
  rig_.run_for(190);
  expect_motors(0.56f);  // the last outputs hold for 0.3 s
  rig_.run_for(10);
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
  rig_.run_for(330);
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

TEST_F(FirmwareFailsafe, AnAirplaneWithoutImuKeepsItsTrims) {
  rig_.store_airplane();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_float(Param::kXEqTorque, 0.2f));
    static_cast<void>(p.set_float(Param::kYEqTorque, -0.1f));
  });
  rig_.start();
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.6f;
  rig_.run_for(100);
  const auto with_imu = rig_.outputs();
  ASSERT_GT(std::abs(with_imu[0] - 0.5f), 0.05f);
  rig_.imu_on = false;
  rig_.run_for(150);
  ASSERT_EQ(rig_.errors(), 0x02);
  for (std::size_t k = 0; k < 14; ++k) EXPECT_NEAR(rig_.outputs()[k], with_imu[k], 1e-6f) << k;
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

TEST_F(FirmwareFailsafe, ASampleFromThePastIsSkippedAndTheErrorEndsWithTheNextGoodOne) {
  fly_quadrotor();
  const auto writes = rig_.board.outputs.writes();
  rig_.imu_offset = hal::milliseconds(-50);
  rig_.pass();
  EXPECT_EQ(rig_.errors(), 0x10);
  EXPECT_TRUE(rig_.armed()) << "errors never disarm";
  EXPECT_EQ(rig_.board.outputs.writes(), writes);
  rig_.imu_offset = Time{0};
  rig_.pass();
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_EQ(rig_.board.outputs.writes(), writes + 1);
}

TEST_F(FirmwareFailsafe, AnImuClockThatWasSetBackIsFollowedAtTheThirdSample) {
  fly_quadrotor();
  const auto writes = rig_.board.outputs.writes();
  rig_.imu_offset = hal::milliseconds(-500);
  for (int k = 0; k < 2; ++k) {
    rig_.pass();
    EXPECT_EQ(rig_.errors(), 0x10);
  }
  EXPECT_EQ(rig_.board.outputs.writes(), writes);
  rig_.pass();
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_EQ(rig_.board.outputs.writes(), writes + 1);
  expect_motors(0.56f, 1e-3f);
}

TEST_F(FirmwareFailsafe, StampsThatRunBackwardsAreAnImuThatDoesNotRespond) {
  fly_quadrotor();
  rig_.imu_drift = hal::microseconds(-2 * FirmwareRig::kPass_us);
  rig_.run_for(95);
  expect_motors(0.56f, 1e-3f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x12);
  rig_.run_for(200);  // the last outputs hold for 0.3 s
  expect_motors(0.0f, 0.0f);
  EXPECT_TRUE(rig_.said("IMU not responding"));
}

TEST_F(FirmwareFailsafe, AStampThatStandsIsAnImuThatDoesNotRespond) {  // weak point 38
  fly_quadrotor();
  rig_.imu_drift = hal::microseconds(-FirmwareRig::kPass_us);
  rig_.run_for(47);  // up to nineteen equal stamps are steps without time
  EXPECT_EQ(rig_.errors(), 0);
  expect_motors(0.56f, 1e-3f);
  rig_.run_for(95);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x02);
  rig_.run_for(200);
  expect_motors(0.0f, 0.0f);
}

TEST_F(FirmwareFailsafe, ASensorThatRepeatsItselfIsAnImuThatDoesNotRespond) {
  fly_quadrotor();
  rig_.dither = false;
  rig_.run_for(140);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x02);
  rig_.run_for(200);
  expect_motors(0.0f, 0.0f);
  rig_.dither = true;
  rig_.run_for(20);
  EXPECT_EQ(rig_.errors(), 0);
  expect_motors(0.56f, 1e-3f);
}

TEST_F(FirmwareFailsafe, OneStampFromTheFutureCostsNoAttitude) {
  // Turning at 1 rad/s with an accelerometer that shows 20 degrees of side force: with the tenfold
  // gain that a restart would bring, the estimate would follow it within a second.
  const auto roll_after = [](bool outlier) {
    FirmwareRig rig;
    rig.store_quadrotor();
    rig.start();
    rig.arm();
    rig.run_for(5000);
    rig.accel_m_s2 = {0.0f, -9.80665f * std::sin(0.35f), -9.80665f * std::cos(0.35f)};
    for (int k = 0; k < 400; ++k) {
      rig.gyro_rad_s = {k < 200 ? 1.0f : -1.0f, 0.0f, 0.0f};
      rig.imu_offset = outlier && k == 50 ? hal::milliseconds(150) : Time{0};
      rig.pass();
      EXPECT_EQ(rig.errors(), 0);
    }
    return rig.firmware().estimator().estimate().roll_rad;
  };
  EXPECT_NEAR(roll_after(true), roll_after(false), 0.1f * 0.0174533f);
}

// Weak point 24: a gap was integrated with one sample.
TEST_F(FirmwareFailsafe, AGapInTheImuDataKeepsTheAttitude) {
  constexpr float kDegree = 0.0174533f;
  for (const std::int64_t gap_ms : {30, 80, 120, 400, 900}) {
    FirmwareRig rig;
    rig.store_quadrotor();
    rig.start();
    rig.arm();
    rig.run_for(3000);
    const auto turn = [&rig](float rate, float seconds) {  // the accelerometer follows
      const Time end = rig.now() + hal::microseconds(static_cast<std::int64_t>(seconds * 1e6f));
      while (rig.now() < end) {
        rig.gyro_rad_s = {rate, 0.0f, 0.0f};
        const float roll = rig.firmware().estimator().estimate().roll_rad;
        rig.accel_m_s2 = {0.0f, -9.80665f * std::sin(roll), -9.80665f * std::cos(roll)};
        rig.pass();
      }
    };
    turn(1.0f, 0.2f);
    const float before = rig.firmware().estimator().estimate().roll_rad;
    rig.imu_on = false;
    rig.run_for(gap_ms);
    rig.imu_on = true;
    rig.pass();
    const float turned = rig.firmware().estimator().estimate().roll_rad - before;
    const float truth = static_cast<float>(gap_ms) * 1e-3f + 0.0025f;
    EXPECT_NEAR(turned, truth, 0.5f * kDegree) << gap_ms;
  }
}

}  // namespace
}  // namespace rosflight::core
