// SPDX-License-Identifier: BSD-3-Clause
// Arming on the ground tests everything at the moment of arming; arming in the air tests nothing.
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr std::size_t kArmSwitch = 5;

class ArmingOnTheGround : public testing::Test {
 protected:
  void start(bool calibrate_gyro) {
    rig_.store_quadrotor();
    rig_.store([calibrate_gyro](Parameters& p) {
      static_cast<void>(p.set_int(Param::kRcArmChn, kArmSwitch));
      static_cast<void>(p.set_int(Param::kArmCalGyro, calibrate_gyro ? 1 : 0));
    });
    rig_.start();
    rig_.run_for(700);
    ASSERT_EQ(rig_.errors(), 0);
  }
  void arm_switch(bool on) { rig_.rc.channels[kArmSwitch] = on ? 1.0f : 0.0f; }
  State state() const { return rig_.firmware().state().state(); }
  float highest() const {
    return *std::max_element(rig_.outputs().begin(), rig_.outputs().begin() + 4);
  }
  FirmwareRig rig_;
};

TEST_F(ArmingOnTheGround, AStickRaisedDuringTheGyroCalibrationDoesNotArm) {
  start(true);
  arm_switch(true);
  rig_.run_for(100);
  ASSERT_EQ(state(), State::kCalibrating);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.9f;
  rig_.run_for(5000);
  EXPECT_EQ(state(), State::kPreflight);
  EXPECT_FALSE(rig_.armed());
  EXPECT_EQ(highest(), 0.0f);
  EXPECT_TRUE(rig_.said("Unable to arm: throttle not low"));
}

TEST_F(ArmingOnTheGround, EveryCheckHoldsAgainWhenTheCalibrationEnds) {
  start(true);
  arm_switch(true);
  rig_.run_for(100);
  ASSERT_EQ(state(), State::kCalibrating);
  rig_.board.mag.put({rig_.now(), {0.2e-4f, 0.0f, 0.4e-4f}, 300.0f});  // answers once, then never
  rig_.run_for(5000);
  EXPECT_TRUE(rig_.armed()) << "2.4 s of silence are not yet 3 s";
  arm_switch(false);
  rig_.run_for(1500);
  ASSERT_FALSE(rig_.armed());
  arm_switch(true);
  rig_.run_for(4000);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: no samples from mag"));
}

TEST_F(ArmingOnTheGround, ADisarmRequestEndsTheCalibrationAndKeepsTheBias) {
  start(true);
  arm_switch(true);
  rig_.run_for(1000);
  ASSERT_EQ(state(), State::kCalibrating);
  rig_.gyro_rad_s = {0.01f, 0.0f, 0.0f};
  arm_switch(false);
  rig_.run_for(200);
  EXPECT_EQ(state(), State::kPreflight);
  EXPECT_FALSE(rig_.firmware().sensors().calibrating_imu());
  rig_.run_for(5000);
  EXPECT_FALSE(rig_.armed());
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kGyroXBias), 1e-6f);
}

TEST_F(ArmingOnTheGround, TheDisarmGestureEndsTheCalibrationToo) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kArmCalGyro, 1)); });
  rig_.start();
  rig_.run_for(700);
  rig_.hold_arming_corner();
  rig_.run_for(1100);
  ASSERT_EQ(state(), State::kCalibrating);
  rig_.rc.channels[FirmwareRig::kYaw] = 0.0f;
  rig_.run_for(1100);
  EXPECT_EQ(state(), State::kPreflight);
  rig_.run_for(4000);
  EXPECT_FALSE(rig_.armed());
}

TEST_F(ArmingOnTheGround, LosingTheRadioDuringTheCalibrationEndsIt) {
  start(true);
  arm_switch(true);
  rig_.run_for(1000);
  ASSERT_EQ(state(), State::kCalibrating);
  rig_.rc_on = false;
  rig_.run_for(250);
  EXPECT_EQ(state(), State::kError);
  EXPECT_FALSE(rig_.firmware().sensors().calibrating_imu());
  rig_.rc_on = true;
  rig_.run_for(5000);
  EXPECT_FALSE(rig_.armed()) << "the switch has to go off and on";
}

TEST_F(ArmingOnTheGround, AMovedVehicleIsRefused) {
  start(false);
  rig_.gyro_rad_s = {0.5f, 0.0f, 0.0f};
  rig_.run_for(100);
  rig_.gyro_rad_s = {1e-6f, 0.0f, 0.0f};
  arm_switch(true);
  rig_.run_for(300);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: vehicle is being moved"));
  arm_switch(false);
  rig_.run_for(500);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(ArmingOnTheGround, ATiltedVehicleIsWarnedAboutAndRefusedByParameter) {
  start(false);
  rig_.accel_m_s2 = {0.0f, -9.80665f * 0.34202f, -9.80665f * 0.93969f};  // 20 degrees
  rig_.run_for(20'000);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
  EXPECT_TRUE(rig_.said("Arming: vehicle is not level"));
  arm_switch(false);
  rig_.run_for(1500);
  rig_.set_param("CHECK_LEVEL", 1);
  rig_.run_for(100);
  arm_switch(true);
  rig_.run_for(1000);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: vehicle is not level"));
}

TEST_F(ArmingOnTheGround, AReceiverAndAnImuAreEnough) {
  start(false);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.run_for(1000);
  EXPECT_NEAR(rig_.outputs()[0], 0.56f, 1e-3f);
}

TEST_F(ArmingOnTheGround, AMotorModelNeedsABatteryThatAnswered) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) {
    static_cast<void>(p.set_int(Param::kRcArmChn, kArmSwitch));
    static_cast<void>(p.set_int(Param::kUseMotorParam, 1));
  });
  rig_.start();
  rig_.run_for(700);
  arm_switch(true);
  rig_.run_for(200);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: no battery or motor parameters"));
  arm_switch(false);
  rig_.run_for(200);
  rig_.board.battery.put({rig_.now(), 24.0f, 1.0f});
  rig_.run_for(50);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(ArmingOnTheGround, AMainLoopThatIsTooSlowIsRefused) {
  start(false);
  rig_.board.system.set_work(hal::microseconds(2100));
  rig_.run_for(20);
  rig_.board.system.set_work(hal::microseconds(1900));
  arm_switch(true);
  rig_.run_for(200);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: main loop too slow"));
  arm_switch(false);
  rig_.run_for(1000);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
  EXPECT_EQ(rig_.firmware().counters().longest(), hal::microseconds(2100));
}

TEST_F(ArmingOnTheGround, AWarningIsGivenForTheEscCalibrationMixer) {
  start(false);
  rig_.set_param("PRIMARY_MIXER", 0);
  rig_.run_for(1000);
  arm_switch(true);
  rig_.run_for(2000);
  ASSERT_TRUE(rig_.armed());
  const auto texts = rig_.got<link::StatusText>();
  EXPECT_TRUE(std::any_of(texts.begin(), texts.end(), [](const link::StatusText& t) {
    return std::string(t.text.data()) == "Arming: ESC calibration mixer chosen" &&
           t.severity == link::Severity::kCritical;
  }));
}

TEST_F(ArmingOnTheGround, AGyroBiasDoesNotMakeAnImuCalibrated) {
  rig_.start();
  rig_.run_for(100);
  rig_.set_param("GYRO_X_BIAS", 0.01f);
  rig_.run_for(100);
  EXPECT_NE(rig_.errors() & 0x20, 0);
  rig_.set_param("ACC_Z_BIAS", 0.01f);
  rig_.run_for(100);
  EXPECT_EQ(rig_.errors() & 0x20, 0);
  rig_.set_param("ACC_Z_BIAS", 0.0f);
  rig_.run_for(100);
  EXPECT_NE(rig_.errors() & 0x20, 0);
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(4000);
  EXPECT_EQ(rig_.errors() & 0x20, 0) << "calibrated, whatever came of it";
  rig_.set_param("GYRO_X_BIAS", 0.02f);
  rig_.run_for(100);
  EXPECT_EQ(rig_.errors() & 0x20, 0);
}

TEST_F(ArmingOnTheGround, APendingRebootEndsByArming) {
  start(false);
  arm_switch(true);
  rig_.run_for(15);  // the frame with the switch is due every 20 ms
  rig_.command(link::Command::kReboot);
  rig_.run_for(200);
  EXPECT_TRUE(rig_.armed());
  EXPECT_FALSE(rig_.board.system.reset_requested());
}

// ---- in the air

class ArmingInTheAir : public ArmingOnTheGround {
 protected:
  void fly() {
    start(true);
    arm_switch(true);
    rig_.run_for(4000);
    ASSERT_TRUE(rig_.armed());
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(1000);
    ASSERT_NEAR(rig_.outputs()[0], 0.56f, 1e-2f);
  }
  /// The switch is off for so long that the firmware disarms.
  void disarm() {
    arm_switch(false);
    ASSERT_GE(rig_.ms_until([this] { return !rig_.armed(); }, 300), 0);
  }
};

TEST_F(ArmingInTheAir, WithinASecondTheOutputsFollowAgainAtOnce) {
  fly();
  disarm();
  EXPECT_EQ(highest(), 0.0f);
  rig_.run_for(700);
  arm_switch(true);
  const std::int64_t ms = rig_.ms_until([this] { return rig_.armed(); }, 100);
  EXPECT_GE(ms, 0) << "no throttle test, no calibration";
  rig_.pass();
  EXPECT_NEAR(rig_.outputs()[0], 0.56f, 1e-2f);
  rig_.run_for(300);
  EXPECT_TRUE(rig_.said("Armed in the air"));
}

TEST_F(ArmingInTheAir, ASecondLaterItIsTheGround) {
  fly();
  disarm();
  rig_.run_for(1100);
  arm_switch(true);
  rig_.run_for(4000);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Unable to arm: throttle not low"));
}

TEST_F(ArmingInTheAir, AfterADisarmAtIdleItIsTheGround) {
  fly();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig_.run_for(500);
  disarm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.run_for(100);
  arm_switch(true);
  rig_.run_for(100);
  EXPECT_FALSE(rig_.armed());
}

TEST_F(ArmingInTheAir, AnErrorThatStillFliesDoesNotRefuseButADeadImuDoes) {
  fly();
  rig_.accel_m_s2 = {0.0f, 0.0f, -20.0f};
  rig_.run_for(700);
  disarm();
  rig_.run_for(10);
  ASSERT_EQ(rig_.errors(), 0x08);
  arm_switch(true);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());

  rig_.run_for(300);
  disarm();
  rig_.imu_on = false;
  rig_.run_for(150);
  arm_switch(true);
  rig_.run_for(200);
  EXPECT_FALSE(rig_.armed());
}

TEST_F(ArmingInTheAir, AccelerationIsNoErrorUntilTheGyroWasAloneForHalfAMinute) {
  fly();
  rig_.inbox.clear();
  rig_.accel_m_s2 = {0.0f, 0.0f, -14.0f};  // climbs with 4 m/s^2
  rig_.run_for(29'000);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.run_for(2'000);
  EXPECT_EQ(rig_.errors(), 0x08);
  EXPECT_TRUE(rig_.armed()) << "an error that still flies";
  rig_.accel_m_s2 = {0.0f, 0.0f, -9.80665f};
  rig_.run_for(200);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.accel_m_s2 = {0.0f, 0.0f, -5.0f};  // sinks
  rig_.run_for(7'000);
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(ArmingInTheAir, NothingIsStored) {
  fly();
  rig_.set_param("PID_ROLL_RATE_P", 0.08f);
  rig_.run_for(50);
  const auto before = rig_.board.storage.bytes();
  disarm();
  rig_.run_for(100);
  arm_switch(true);
  rig_.run_for(50);
  ASSERT_TRUE(rig_.armed());
  EXPECT_EQ(rig_.board.storage.bytes(), before);
}

}  // namespace
}  // namespace rosflight::core
