// SPDX-License-Identifier: BSD-3-Clause
// Start-up, errors, arming and disarming of the whole firmware.
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareArming : public testing::Test {
 protected:
  FirmwareRig rig_;
};

TEST_F(FirmwareArming, WithDefaultsTheErrorWordIsMixerCalibrationAndFailsafe) {
  rig_.start();
  rig_.run_for(100);
  EXPECT_EQ(rig_.errors(), 0xA1);
  const auto status = rig_.got<link::Status>();
  ASSERT_FALSE(status.empty());
  EXPECT_EQ(status.back().error_code, 0xA1);
}

TEST_F(FirmwareArming, WithoutFramesTheRadioIsLostAfterTwoTenthsOfASecond) {
  rig_.rc_on = false;
  rig_.start();
  rig_.run_for(195);
  EXPECT_EQ(rig_.errors(), 0xA1);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0xA5);
  EXPECT_EQ(rig_.firmware().state().state(), State::kError);
  EXPECT_FALSE(rig_.firmware().state().failsafe());
}

TEST_F(FirmwareArming, SticksArmAndDisarmAfterASecond) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(200);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.hold_arming_corner();
  rig_.run_for(1000);
  EXPECT_FALSE(rig_.armed());
  rig_.run_for(60);
  EXPECT_TRUE(rig_.armed());
  rig_.rc.channels[FirmwareRig::kYaw] = 0.0f;
  rig_.run_for(1000);
  EXPECT_TRUE(rig_.armed());
  rig_.run_for(60);
  EXPECT_FALSE(rig_.armed());
  EXPECT_TRUE(rig_.said("Armed"));
  EXPECT_TRUE(rig_.said("Disarmed"));
}

TEST_F(FirmwareArming, ASwitchArmsAtOnceAndDisarmsAfterATenthOfASecond) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 5)); });
  rig_.start();
  rig_.run_for(200);
  rig_.hold_arming_corner();
  rig_.run_for(1500);
  EXPECT_FALSE(rig_.armed()) << "no arming by sticks when a switch is mapped";
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
  rig_.rc.channels[5] = 0.0f;
  rig_.run_for(95);
  EXPECT_TRUE(rig_.armed()) << "a glitch of the receiver would do as much";
  rig_.run_for(35);
  EXPECT_FALSE(rig_.armed());
}

// Weak point 17.
TEST_F(FirmwareArming, ASwitchThatIsOnAtPowerUpHasToGoOffFirst) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 5)); });
  rig_.rc.channels[5] = 1.0f;
  rig_.start();
  rig_.run_for(3000);
  EXPECT_EQ(rig_.errors(), 0);
  EXPECT_FALSE(rig_.armed());
  rig_.rc.channels[5] = 0.0f;
  rig_.run_for(50);
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(50);
  EXPECT_FALSE(rig_.armed()) << "off for a moment only";
  rig_.rc.channels[5] = 0.0f;
  rig_.run_for(130);
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(FirmwareArming, MovingTheArmSwitchByParameterDoesNotArm) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 4)); });
  rig_.rc.channels[5] = 1.0f;
  rig_.start();
  rig_.run_for(200);
  rig_.set_param("RC_ARM_CHN", 5);
  rig_.run_for(500);
  EXPECT_EQ(rig_.firmware().parameters().get_int(Param::kRcArmChn), 5);
  EXPECT_FALSE(rig_.armed());
}

TEST_F(FirmwareArming, AHighThrottleIsRefusedWithItsText) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kRcArmChn, 5)); });
  rig_.start();
  rig_.run_for(200);
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.15f;
  rig_.rc.channels[5] = 1.0f;
  rig_.run_for(2000);
  EXPECT_FALSE(rig_.armed());
  EXPECT_EQ(rig_.count_text("Unable to arm: throttle not low"), 1u) << "one edge, one text";
}

TEST_F(FirmwareArming, WithoutLeastThrottleTheOverrideSwitchMustBeOn) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_int(Param::kTakeMinThr, 0)); });
  rig_.start();
  rig_.run_for(200);
  rig_.hold_arming_corner();
  rig_.run_for(3300);
  EXPECT_FALSE(rig_.armed());
  EXPECT_EQ(rig_.count_text("Unable to arm: throttle override switch is off"), 3u)
      << "requested at every frame, reported once a second";
  rig_.rc.channels[4] = 1.0f;
  rig_.run_for(50);
  EXPECT_TRUE(rig_.armed());
}

// ---- errors, alone and together

/// Makes and removes the seven errors that this firmware can have, one bit each.
class FirmwareErrors : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const int wanted = GetParam();
    rig_.store([wanted](Parameters& p) {
      if ((wanted & 0x01) == 0) static_cast<void>(p.set_int(Param::kPrimaryMixer, 2));
      if ((wanted & 0x20) == 0) static_cast<void>(p.set_float(Param::kAccXBias, 1e-6f));
      if ((wanted & 0x80) == 0) static_cast<void>(p.set_float(Param::kFailsafeThr, 0.4f));
    });
    if ((wanted & 0x20) != 0) rig_.gyro_rad_s = {};
  }
  FirmwareRig rig_;
};

/// In the order of the error word: mixer, IMU, RC, estimator, time, calibration, failsafe.
struct Reason {
  int bit;
  const char* text;
};
constexpr std::array<Reason, 7> kReasons{{{0x01, "Unable to arm: invalid mixer"},
                                          {0x02, "Unable to arm: IMU not responding"},
                                          {0x04, "Unable to arm: RC signal lost"},
                                          {0x08, "Unable to arm: unhealthy estimator"},
                                          {0x10, "Unable to arm: time going backwards"},
                                          {0x20, "Unable to arm: IMU not calibrated"},
                                          {0x80, "Unable to arm: FAILSAFE_THR not set"}}};

TEST_P(FirmwareErrors, WordStatusAndRefusalsFollow) {
  int wanted = GetParam();
  rig_.start();
  rig_.run_for(100);
  if ((wanted & 0x08) != 0) rig_.accel_m_s2 = {0.0f, 0.0f, -20.0f};
  rig_.run_for(1000);
  ASSERT_EQ(rig_.errors(), wanted & ~0x16);
  if ((wanted & 0x10) != 0) rig_.imu_drift = hal::microseconds(-2 * FirmwareRig::kPass_us);
  rig_.pass();
  if ((wanted & 0x02) != 0) rig_.imu_on = false;
  if ((wanted & 0x10) != 0) wanted |= 0x02;  // samples of no known time are as none
  rig_.hold_arming_corner();
  rig_.run_for(110);
  if ((wanted & 0x04) != 0) rig_.rc.failsafe = true;
  rig_.run_for(40);
  rig_.inbox.clear();
  rig_.run_for(1100);

  EXPECT_EQ(rig_.errors(), wanted);
  EXPECT_EQ(rig_.got<link::Status>().back().error_code, wanted);
  EXPECT_EQ(rig_.armed(), wanted == 0);
  for (const Reason& reason : kReasons) {
    // Without the radio nobody asks.
    const bool told = (wanted & reason.bit) != 0 && (wanted & 0x04) == 0;
    EXPECT_EQ(rig_.count_text(reason.text), told ? 1u : 0u) << reason.text;
  }
}

std::vector<int> error_words() {
  std::vector<int> words{0};
  constexpr int kUsed = 0x01 | 0x02 | 0x04 | 0x08 | 0x10 | 0x20 | 0x80;
  for (int w = 1; w < 256; ++w) {
    if ((w & ~kUsed) == 0) words.push_back(w);
  }
  return words;
}

INSTANTIATE_TEST_SUITE_P(AloneAndTogether, FirmwareErrors, testing::ValuesIn(error_words()));

}  // namespace
}  // namespace rosflight::core
