// SPDX-License-Identifier: BSD-3-Clause
// Two things at a time, on the whole firmware: what one of them hid from the other.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr std::size_t kArmSwitch = 5;
constexpr std::size_t kAuxiliary = 8;

class FirmwarePairs : public testing::Test {
 protected:
  void start(const std::function<void(Parameters&)>& change = [](Parameters&) {}) {
    rig_.store_quadrotor();
    rig_.store([&change](Parameters& p) {
      static_cast<void>(p.set_int(Param::kRcArmChn, kArmSwitch));
      change(p);
    });
    rig_.start();
    rig_.run_for(1000);
  }
  void arm_switch(bool on) { rig_.rc.channels[kArmSwitch] = on ? 1.0f : 0.0f; }
  void stick(float value) { rig_.rc.channels[FirmwareRig::kThrottle] = value; }
  State state() const { return rig_.firmware().state().state(); }
  float parameter(Param id) const { return rig_.firmware().parameters().get_float(id); }
  bool arms_within(std::int64_t ms) {
    return rig_.ms_until([this] { return rig_.armed(); }, ms) >= 0;
  }
  void fly() {
    arm_switch(true);
    ASSERT_TRUE(arms_within(4000));
    rig_.run_for(600);
    stick(0.6f);
    rig_.run_for(200);
    ASSERT_GT(rig_.outputs()[0], 0.2f);
  }
  void disarm_in_flight() {
    arm_switch(false);
    ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 400), 0);
  }
  static link::AuxCommand auxiliary(float value) {
    link::AuxCommand command;
    command.type[kAuxiliary] = static_cast<std::uint8_t>(link::AuxType::kMotor);
    command.value[kAuxiliary] = value;
    return command;
  }
  void fly_with_auxiliary_motor() {
    fly();
    rig_.send(auxiliary(0.8f));
    rig_.run_for(100);
    ASSERT_FLOAT_EQ(rig_.outputs()[kAuxiliary], 0.8f);
  }
  void receive_frame() {
    rig_.board.receiver.put(rig_.rc);
    rig_.pass();
  }

  FirmwareRig rig_;
};

// ---- an auxiliary motor, and an IMU that has no sample meanwhile

TEST_F(FirmwarePairs, AFailsafeWithinAnImuGapEndsAnAuxiliaryMotor) {
  start();
  fly_with_auxiliary_motor();
  rig_.imu_on = false;
  rig_.run_for(50);
  rig_.rc.failsafe = true;
  rig_.run_for(30);
  ASSERT_TRUE(rig_.firmware().state().failsafe());
  EXPECT_EQ(rig_.outputs()[kAuxiliary], 0.0f) << "in the next pass, not with the next sample";
  rig_.rc.failsafe = false;
  rig_.run_for(30);
  rig_.imu_on = true;
  rig_.run_for(50);
  ASSERT_FALSE(rig_.firmware().state().failsafe());
  EXPECT_EQ(rig_.outputs()[kAuxiliary], 0.0f);
}

TEST_F(FirmwarePairs, AFailsafeOfOneFrameBetweenTwoImuSamplesEndsAnAuxiliaryMotor) {
  start();
  fly_with_auxiliary_motor();
  rig_.rc_on = rig_.imu_on = false;
  rig_.rc.failsafe = true;
  receive_frame();
  ASSERT_TRUE(rig_.firmware().state().failsafe());
  rig_.rc.failsafe = false;
  receive_frame();
  ASSERT_FALSE(rig_.firmware().state().failsafe());
  rig_.rc_on = rig_.imu_on = true;
  rig_.run_for(50);
  EXPECT_EQ(rig_.outputs()[kAuxiliary], 0.0f);
}

TEST_F(FirmwarePairs, ASilentCompanionWithinAnImuGapEndsAnAuxiliaryMotor) {
  start();
  fly_with_auxiliary_motor();
  rig_.companion_on = false;
  rig_.run_for(800);
  ASSERT_FLOAT_EQ(rig_.outputs()[kAuxiliary], 0.8f);
  rig_.imu_on = false;
  rig_.run_for(900);
  rig_.send(link::Heartbeat{});
  rig_.run_for(10);
  rig_.imu_on = true;
  rig_.run_for(50);
  EXPECT_EQ(rig_.outputs()[kAuxiliary], 0.0f);
}

TEST_F(FirmwarePairs, AnAuxiliaryCommandAfterArmingCountsThoughNoImuSampleCameYet) {
  start();
  arm_switch(true);
  ASSERT_TRUE(arms_within(100));
  rig_.imu_on = false;
  rig_.send(auxiliary(0.3f));
  rig_.pass();
  rig_.imu_on = true;
  rig_.run_for(700);
  EXPECT_FLOAT_EQ(rig_.outputs()[kAuxiliary], 0.3f);
}

// ---- arming, and a queue of messages that came before it

class ArmingBehindAQueue : public FirmwarePairs, public testing::WithParamInterface<int> {};

TEST_P(ArmingBehindAQueue, ACommandFromBeforeArmingIsNotExecutedAfterIt) {
  start([](Parameters& p) {
    static_cast<void>(p.set_int(Param::kTakeMinThr, 0));
    static_cast<void>(p.set_int(Param::kRcNumChn, 8));
    static_cast<void>(p.set_int(Param::kRcThrOvrdChn, 6));
  });
  rig_.rc.channels[6] = 1.0f;  // the throttle override, as arming demands
  rig_.run_for(100);
  const auto requests = GetParam();
  for (int k = 0; k < requests; ++k) {
    rig_.send(link::ParamRequestRead{1, -1, param_name("SYS_ID")});
  }
  rig_.send(link::OffboardControl{2, 0, {0, 0, 0.9f, 0, 0, 0, 0, 0, 0, 0}});
  rig_.send(auxiliary(0.8f));
  rig_.rc_on = false;
  arm_switch(true);
  receive_frame();
  ASSERT_TRUE(rig_.armed());
  rig_.rc.channels[6] = 0.0f;
  for (int k = 0; k < 180; ++k) {
    if (k % 8 == 7) rig_.board.receiver.put(rig_.rc);
    rig_.pass();
    ASSERT_LE(rig_.outputs()[0], 0.1001f) << k;
    ASSERT_EQ(rig_.outputs()[kAuxiliary], 0.0f) << k;
  }
  rig_.send(link::OffboardControl{2, 0, {0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0}});
  rig_.send(auxiliary(0.4f));
  rig_.pass();
  rig_.pass();
  EXPECT_GT(rig_.outputs()[0], 0.2f) << "what comes after arming counts";
  EXPECT_FLOAT_EQ(rig_.outputs()[kAuxiliary], 0.4f);
}

INSTANTIATE_TEST_SUITE_P(Requests, ArmingBehindAQueue, testing::Values(0, 5, 30, 60));

// ---- a gyro offset, and the calibration that measures it

class ArmingWithAGyroOffset : public testing::TestWithParam<float> {};

TEST_P(ArmingWithAGyroOffset, AVehicleAtRestArmsAndIsLevelWhateverIsStored) {
  const float offset = GetParam();
  for (const bool stored : {true, false}) {
    FirmwareRig rig;
    rig.store_quadrotor();
    rig.store([&](Parameters& p) {
      static_cast<void>(p.set_int(Param::kArmCalGyro, 1));
      static_cast<void>(p.set_int(Param::kCheckLevel, 1));
      static_cast<void>(p.set_int(Param::kRcArmChn, kArmSwitch));
      for (const Param id : {Param::kGyroXBias, Param::kGyroYBias, Param::kGyroZBias}) {
        static_cast<void>(p.set_float(id, stored ? offset : 0.0f));
      }
    });
    rig.gyro_rad_s = {offset, offset, offset};
    rig.start();
    rig.run_for(4000);
    rig.rc.channels[kArmSwitch] = 1.0f;
    ASSERT_GE(rig.ms_until([&rig] { return rig.armed(); }, 6000), 0) << "stored: " << stored;
    const AttitudeEstimate& e = rig.firmware().estimator().estimate();
    const float tilt = std::max(std::abs(e.roll_rad), std::abs(e.pitch_rad));
    EXPECT_LE(tilt, 3.0f * kRadPerDeg) << "stored: " << stored;
  }
}

INSTANTIATE_TEST_SUITE_P(Offsets, ArmingWithAGyroOffset,
                         testing::Values(0.0f, 0.02f, 0.03f, 0.05f, 0.1f, 0.15f, 0.2f, 0.25f,
                                         0.33f));

TEST_F(FirmwarePairs, ArmingDuringAGyroCalibrationByCommandKeepsTheAttitude) {
  rig_.gyro_rad_s = {0.29f, 0.0f, 0.0f};
  start([](Parameters& p) { static_cast<void>(p.set_float(Param::kGyroXBias, 0.29f)); });
  rig_.run_for(3000);
  rig_.command(link::Command::kGyroCalibration);
  rig_.run_for(2400);
  arm_switch(true);
  ASSERT_TRUE(arms_within(500));
  EXPECT_NEAR(rig_.firmware().estimator().estimate().roll_rad, 0.0f, 3.0f * kRadPerDeg);
}

TEST_F(FirmwarePairs, ASwitchThatGoesOffAsTheCalibrationEndsDoesNotArm) {
  start([](Parameters& p) { static_cast<void>(p.set_int(Param::kArmCalGyro, 1)); });
  arm_switch(true);
  ASSERT_GE(rig_.ms_until([this] { return state() == State::kCalibrating; }, 100), 0);
  rig_.run_for(2430);
  ASSERT_EQ(state(), State::kCalibrating);
  arm_switch(false);
  EXPECT_FALSE(arms_within(500));
}

// ---- a calibration, and who changes its result

TEST_F(FirmwarePairs, AnAccelerometerCalibrationDoesNotOutliveItsBiases) {
  start();
  rig_.accel_m_s2 = {0.5f, 0.3f, -9.9f};
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(3500);
  ASSERT_NE(parameter(Param::kAccXBias), 0.0f);
  ASSERT_FALSE(rig_.firmware().state().has(Error::kUncalibratedImu));
  for (const char* name : {"ACC_X_BIAS", "ACC_Y_BIAS", "ACC_Z_BIAS"}) rig_.set_param(name, 0.0f);
  rig_.run_for(100);
  EXPECT_TRUE(rig_.firmware().state().has(Error::kUncalibratedImu));
}

TEST_F(FirmwarePairs, AnAccelerometerCalibrationDoesNotOutliveTheDefaults) {
  start();
  rig_.accel_m_s2 = {0.5f, 0.3f, -9.9f};
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(3500);
  rig_.command(link::Command::kSetParamDefaults);
  rig_.run_for(100);
  EXPECT_TRUE(rig_.firmware().state().has(Error::kUncalibratedImu));
}

TEST_F(FirmwarePairs, ACalibrationThatFindsNoOffsetCounts) {
  start([](Parameters& p) { static_cast<void>(p.set_float(Param::kAccXBias, 0.2f)); });
  rig_.accel_m_s2 = {0.0f, 0.0f, -kGravity_m_s2};
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(3500);
  ASSERT_NEAR(parameter(Param::kAccXBias), 0.0f, 1e-6f);
  EXPECT_FALSE(rig_.firmware().state().has(Error::kUncalibratedImu));
}

TEST_F(FirmwarePairs, NoTrimIsTakenFromTheSticksOfALostRadio) {
  start();
  rig_.rc.channels[FirmwareRig::kRoll] = 0.7f;
  rig_.run_for(100);
  rig_.rc_on = false;
  rig_.run_for(1000);
  rig_.command(link::Command::kRcCalibration);
  rig_.run_for(300);
  EXPECT_EQ(parameter(Param::kXEqTorque), 0.0f);
  EXPECT_TRUE(rig_.said("RC signal lost: no trim"));
}

// ---- the disarmed moment of a flight

TEST_F(FirmwarePairs, WhatIsLockedInFlightIsLockedInItsDisarmedMomentToo) {
  start();
  fly();
  disarm_in_flight();
  rig_.set_param("RC_F_CHN", std::int32_t{7});
  rig_.set_param("GYRO_X_BIAS", 0.9f);
  rig_.set_param("MOTOR_IDLE_THR", 0.0f);
  rig_.command(link::Command::kSetParamDefaults);
  rig_.send(link::MotorTest{1, 2, 0.3f});
  rig_.run_for(50);
  EXPECT_EQ(state(), State::kPreflight) << "no motor test";
  arm_switch(true);
  ASSERT_TRUE(arms_within(100));
  rig_.run_for(50);
  EXPECT_NEAR(parameter(Param::kGyroXBias), 0.0f, 1e-5f);
  EXPECT_GT(rig_.outputs()[0], 0.2f) << "it flies on";
  disarm_in_flight();
  rig_.run_for(1100);
  rig_.set_param("MOTOR_IDLE_THR", 0.05f);
  rig_.run_for(50);
  EXPECT_EQ(parameter(Param::kMotorIdleThr), 0.05f) << "a second later it is on the ground";
}

TEST_F(FirmwarePairs, ADisarmWithinAnImuGapAtIdleIsOnTheGround) {
  start();
  arm_switch(true);
  ASSERT_TRUE(arms_within(400));
  rig_.run_for(700);
  rig_.imu_on = false;
  rig_.run_for(150);
  disarm_in_flight();
  rig_.imu_on = true;
  stick(0.6f);
  arm_switch(true);
  EXPECT_FALSE(arms_within(500)) << "the throttle is up";
}

TEST_F(FirmwarePairs, AVehicleThatTurnedWhileArmedHasToStandStillBeforeItArmsAgain) {
  start();
  arm_switch(true);
  ASSERT_TRUE(arms_within(400));
  rig_.run_for(600);
  rig_.gyro_rad_s = {0.0f, 0.0f, 2.0f};
  rig_.run_for(3000);
  arm_switch(false);
  rig_.run_for(70);
  rig_.gyro_rad_s = {0.0f, 1e-6f, 0.0f};
  ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 400), 0);
  arm_switch(true);
  EXPECT_FALSE(arms_within(300));
  EXPECT_TRUE(rig_.said("Unable to arm: vehicle is being moved"));
}

// ---- receiver

TEST_F(FirmwarePairs, TheSwitchDisarmsThoughEveryFourthFrameIsShort) {
  start();
  fly();
  stick(0.0f);
  arm_switch(false);
  rig_.rc_on = false;
  int passes = 0;
  for (; passes < 400 && rig_.armed(); ++passes) {
    if (passes % 8 == 0) {
      rig_.rc.channel_count = passes / 8 % 4 == 0 ? 5 : 8;
      rig_.board.receiver.put(rig_.rc);
    }
    rig_.pass();
  }
  EXPECT_LE(passes, 80) << "0.2 s";
}

// ---- both mixers

TEST_F(FirmwarePairs, TheEscCalibrationMixerIsToldAsTheSecondaryToo) {
  start();
  rig_.set_param("SECONDARY_MIXER", std::int32_t{0});
  rig_.run_for(300);
  EXPECT_TRUE(rig_.said("ESC calibration mixer as secondary"));
  arm_switch(true);
  rig_.run_for(2000);
  EXPECT_TRUE(rig_.said("Arming: ESC calibration mixer chosen"));
}

TEST_F(FirmwarePairs, ABatteryWithoutVoltageIsNoBatteryForTheMotorModel) {
  start([](Parameters& p) { static_cast<void>(p.set_int(Param::kUseMotorParam, 1)); });
  rig_.board.battery.put({rig_.now(), 0.0f, 0.0f});
  rig_.run_for(50);
  arm_switch(true);
  EXPECT_FALSE(arms_within(300));
  EXPECT_TRUE(rig_.said("Unable to arm: no battery or motor parameters"));
}

}  // namespace
}  // namespace rosflight::core
