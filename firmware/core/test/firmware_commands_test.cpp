// SPDX-License-Identifier: BSD-3-Clause
// The commands of the companion: version, reboot, calibrations, trim.
#include "firmware/core/test/firmware_rig.hpp"
#include "firmware/core/version.hpp"

namespace rosflight::core {
namespace {

class FirmwareCommands : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
  }
  std::vector<bool> acks(std::uint8_t command) const {
    std::vector<bool> found;
    for (const auto& ack : rig_.got<link::CommandAck>()) {
      if (ack.command == command) found.push_back(ack.success);
    }
    return found;
  }
  std::vector<bool> acks(link::Command c) const { return acks(static_cast<std::uint8_t>(c)); }

  FirmwareRig rig_;
};

TEST_F(FirmwareCommands, WhileArmedOnlyTheVersionIsAnswered) {  // weak point 61
  start();
  rig_.arm();
  for (int c = 0; c < 256; ++c) {
    rig_.inbox.clear();
    rig_.send(link::CommandRequest{static_cast<std::uint8_t>(c)});
    rig_.pass();
    ASSERT_EQ(acks(static_cast<std::uint8_t>(c)), (std::vector<bool>{c == 10})) << c;
    EXPECT_EQ(rig_.got<link::Version>().size(), c == 10 ? 1u : 0u);
  }
  rig_.run_for(100);
  EXPECT_FALSE(rig_.board.system.reset_requested());
}

TEST_F(FirmwareCommands, UnknownCommandsAreRefusedWhileDisarmedToo) {
  start();
  rig_.run_for(100);
  for (int c = 11; c < 256; ++c) {
    rig_.inbox.clear();
    rig_.send(link::CommandRequest{static_cast<std::uint8_t>(c)});
    rig_.pass();
    ASSERT_EQ(acks(static_cast<std::uint8_t>(c)), (std::vector<bool>{false})) << c;
  }
}

TEST_F(FirmwareCommands, TheVersionComesBeforeItsAcknowledgePaddedWithZeros) {
  start();
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.command(link::Command::kSendVersion);
  rig_.pass();
  const auto version = rig_.got<link::Version>();
  ASSERT_EQ(version.size(), 1u);
  EXPECT_STREQ(version[0].text.data(), kVersion);
  EXPECT_EQ(std::string(kVersion).substr(0, 4), "2.0.") << "what companions compare";
  for (std::size_t k = std::strlen(kVersion); k < version[0].text.size(); ++k) {
    EXPECT_EQ(version[0].text[k], '\0');
  }
  bool version_seen = false;
  for (const auto& r : rig_.inbox) {
    version_seen = version_seen || std::holds_alternative<link::Version>(r.message);
    if (std::holds_alternative<link::CommandAck>(r.message)) {
      EXPECT_TRUE(version_seen);
    }
  }
}

TEST_F(FirmwareCommands,
       RebootIsAcknowledgedThenTheBoardResetsWithItsOutputsOff) {  // weak point 65
  for (const bool bootloader : {false, true}) {
    FirmwareRig rig;
    rig.store_quadrotor();
    rig.start();
    rig.run_for(100);
    rig.inbox.clear();
    rig.command(bootloader ? link::Command::kRebootToBootloader : link::Command::kReboot);
    rig.pass();
    ASSERT_EQ(rig.got<link::CommandAck>().size(), 1u);
    EXPECT_TRUE(rig.got<link::CommandAck>()[0].success);
    EXPECT_FALSE(rig.board.system.reset_requested()) << "the acknowledge has to get out";
    rig.run_for(20);
    EXPECT_TRUE(rig.board.system.reset_requested());
    EXPECT_EQ(rig.board.system.to_bootloader(), bootloader);
    EXPECT_FALSE(rig.board.outputs.enabled());
  }
}

TEST_F(FirmwareCommands, GyroCalibrationMeasuresStoresAndTells) {
  start();
  rig_.run_for(100);
  rig_.gyro_rad_s = {0.01f, -0.02f, 0.03f};
  rig_.command(link::Command::kGyroCalibration);
  rig_.pass();
  EXPECT_EQ(acks(link::Command::kGyroCalibration), std::vector<bool>{true});
  rig_.run_for(1001 * 5 / 2 + 50);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kGyroXBias), 0.01f, 1e-5f);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kGyroYBias), -0.02f, 1e-5f);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kGyroZBias), 0.03f, 1e-5f);
  EXPECT_TRUE(rig_.said("Gyro calibration complete"));  // weak point 35
  EXPECT_EQ(rig_.values_of("GYRO_Z_BIAS").size(), 1u);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareCommands, AccelerometerCalibrationMeasuresClearsTheErrorAndTells) {
  rig_.start();
  rig_.run_for(100);
  ASSERT_EQ(rig_.errors() & 0x20, 0x20);
  rig_.accel_m_s2 = {0.1f, 0.2f, -9.5f};
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(2700);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kAccXBias), 0.1f, 1e-3f);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kAccZBias), 0.30665f, 1e-3f);
  EXPECT_EQ(rig_.errors() & 0x20, 0);
  EXPECT_TRUE(rig_.said("IMU offsets captured"));
  EXPECT_EQ(acks(link::Command::kAccelCalibration), std::vector<bool>{true});
}

TEST_F(FirmwareCommands, PerfectSensorsAreCalibratedToo) {
  rig_.gyro_rad_s = {};
  rig_.start();
  rig_.run_for(100);
  rig_.command(link::Command::kAccelCalibration);
  rig_.run_for(2700);
  EXPECT_EQ(rig_.errors() & 0x20, 0) << "all six biases are zero, but measured";
}

TEST_F(FirmwareCommands, AFailedCalibrationKeepsTheBiasesInForce) {  // weak point 34
  start();
  rig_.run_for(100);
  rig_.gyro_rad_s = {1.5f, 0.0f, 0.0f};
  rig_.command(link::Command::kGyroCalibration);
  rig_.run_for(2700);
  EXPECT_TRUE(rig_.said("Gyro calibration refused: mean 1.50 rad/s"));
  EXPECT_FLOAT_EQ(rig_.firmware().parameters().get_float(Param::kGyroXBias), 1e-6f);
  EXPECT_EQ(rig_.errors() & 0x20, 0);
}

TEST_F(FirmwareCommands, PressureCalibrationsAreAcknowledgedAndTold) {
  start();
  rig_.command(link::Command::kBaroCalibration);
  rig_.command(link::Command::kAirspeedCalibration);
  rig_.ms_until(
      [this] {
        rig_.board.baro.put({rig_.now(), 100'000.0f, 300.0f});
        rig_.board.diff_pressure.put({rig_.now(), 12.5f, 300.0f});
        return rig_.said("Baro Cal successful!") && rig_.said("Airspeed Cal Successful!");
      },
      8000);
  EXPECT_EQ(acks(link::Command::kBaroCalibration), std::vector<bool>{true});
  EXPECT_EQ(acks(link::Command::kAirspeedCalibration), std::vector<bool>{true});
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kBaroBias), 100'000.0f, 1.0f);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kGroundLevel), 110.9f, 1.0f);
  EXPECT_FLOAT_EQ(rig_.firmware().parameters().get_float(Param::kDiffPressBias), 12.5f);
}

TEST_F(FirmwareCommands, TrimCaptureTakesTheSticksTimesTheGain) {
  start();
  rig_.rc.channels[FirmwareRig::kRoll] = 0.55f;
  rig_.run_for(100);
  rig_.command(link::Command::kRcCalibration);
  rig_.run_for(100);
  EXPECT_EQ(acks(link::Command::kRcCalibration), std::vector<bool>{true});
  // K_P of the angle loop x RC_MAX_ROLL x stick
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kXEqTorque), 0.15f * 0.786f * 0.1f,
              1e-6f);
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kYEqTorque), 0.0f);
  EXPECT_TRUE(rig_.said("Equilibrium torques found and applied"));
  rig_.command(link::Command::kRcCalibration);
  rig_.run_for(100);
  EXPECT_NEAR(rig_.firmware().parameters().get_float(Param::kXEqTorque), 0.3f * 0.786f * 0.1f,
              1e-6f)
      << "added to what was there";
}

TEST_F(FirmwareCommands, TrimOutOfRangeIsTakenOnNoAxis) {
  rig_.store_quadrotor();
  rig_.store([](Parameters& p) { static_cast<void>(p.set_float(Param::kYEqTorque, 100.0f)); });
  rig_.start();
  rig_.rc.channels[FirmwareRig::kRoll] = 0.55f;
  rig_.rc.channels[FirmwareRig::kPitch] = 0.55f;
  rig_.run_for(100);
  rig_.command(link::Command::kRcCalibration);
  rig_.run_for(200);
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kXEqTorque), 0.0f);
  EXPECT_EQ(rig_.firmware().parameters().get_float(Param::kYEqTorque), 100.0f);
  EXPECT_TRUE(rig_.said("Equilibrium torque out of range, not taken"));
}

}  // namespace
}  // namespace rosflight::core
