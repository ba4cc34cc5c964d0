// SPDX-License-Identifier: BSD-3-Clause
// What must not happen in the air or on a bad day, on the whole firmware.
#include <gtest/gtest.h>

#include <limits>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(FirmwareSafeguards, ArmingForgetsACalibrationThatIsUnderWay) {
  // It would end in the air, take the motion for a bias and start the estimator again.
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.run_for(500);
  rig.command(link::Command::kAccelCalibration);
  rig.run_for(50);
  ASSERT_TRUE(rig.firmware().sensors().calibrating_imu());
  rig.arm();
  EXPECT_FALSE(rig.firmware().sensors().calibrating_imu());
  rig.gyro_rad_s = {0.3f, -0.2f, 0.1f};
  rig.run_for(3000);  // 1001 samples at 400 Hz are 2.5 s
  EXPECT_TRUE(rig.armed());
  EXPECT_EQ(rig.firmware().parameters().get_float(Param::kGyroXBias), 1e-6f);
  EXPECT_EQ(rig.firmware().parameters().get_float(Param::kAccXBias), 1e-6f);
}

/// An auxiliary motor on output 10 at 0.8 and a servo on output 11 at 0.75.
link::AuxCommand motor_and_servo() {
  link::AuxCommand aux;
  aux.type[10] = static_cast<std::uint8_t>(link::AuxType::kMotor);
  aux.value[10] = 0.8f;
  aux.type[11] = static_cast<std::uint8_t>(link::AuxType::kServo);
  aux.value[11] = 0.5f;
  return aux;
}

TEST(FirmwareSafeguards, AnAuxiliaryMotorRunsOnOneCommandUntilTheCompanionIsSilentForASecond) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.arm();
  rig.send(motor_and_servo());
  rig.run_for(10'000);  // heartbeats alone, once a second
  EXPECT_FLOAT_EQ(rig.outputs()[10], 0.8f);
  rig.companion_on = false;
  rig.send(link::TimeSync{});
  EXPECT_NEAR(static_cast<float>(rig.ms_until([&rig] { return rig.outputs()[10] == 0.0f; }, 2000)),
              1000.0f, 5.0f);
  EXPECT_FLOAT_EQ(rig.outputs()[11], 0.75f) << "servos hold";
  EXPECT_TRUE(rig.armed());
  rig.companion_on = true;
  rig.run_for(2000);
  EXPECT_EQ(rig.outputs()[10], 0.0f) << "it takes a new command";
}

TEST(FirmwareSafeguards, MessagesForAnotherSystemDoNotKeepAnAuxiliaryMotorRunning) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.arm();
  rig.send(motor_and_servo());
  rig.companion_on = false;
  constexpr std::uint8_t kOther = 77;
  for (int k = 0; k < 15; ++k) {
    rig.send(link::ParamRequestRead{kOther, 1, {}});
    rig.send(link::ParamRequestList{kOther});
    rig.send(link::ParamSet{kOther, param_name("SYS_ID"), {1}, 6});
    rig.send(link::MotorTest{kOther, 0, 0.1f});
    rig.send(link::ReportRequest{kOther, 0});
    rig.run_for(100);
  }
  EXPECT_EQ(rig.outputs()[10], 0.0f);
}

TEST(FirmwareSafeguards, AnAuxiliaryMotorReleasedWithoutImuStops) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.arm();
  rig.send(motor_and_servo());
  rig.run_for(100);
  ASSERT_FLOAT_EQ(rig.outputs()[10], 0.8f);
  rig.imu_on = false;
  rig.send(link::AuxCommand{});  // all released before the silence of the IMU is known
  rig.run_for(320);
  EXPECT_EQ(rig.outputs()[10], 0.0f);
  EXPECT_FLOAT_EQ(rig.outputs()[11], 0.75f) << "servos hold";
}

TEST(FirmwareSafeguards, AServoThatBecomesAMotorStopsInThatPassImuOrNot) {
  FirmwareRig rig;
  rig.store_airplane();
  rig.start();
  rig.run_for(100);
  ASSERT_FLOAT_EQ(rig.outputs()[0], 0.5f);
  rig.imu_on = false;
  rig.set_param("PRI_MIXER_OUT_0", 2);
  rig.pass();
  EXPECT_EQ(rig.outputs()[0], 0.0f);
}

TEST(FirmwareSafeguards, AnAuxiliaryMotorEndsWithFailsafeAndWithDisarmingForGood) {
  for (const bool disarm : {false, true}) {
    FirmwareRig rig;
    rig.store_quadrotor();
    rig.start();
    rig.arm();
    rig.send(motor_and_servo());
    rig.run_for(100);
    ASSERT_FLOAT_EQ(rig.outputs()[10], 0.8f);
    if (disarm) {
      rig.rc.channels[FirmwareRig::kYaw] = 0.0f;
      ASSERT_GE(rig.ms_until([&rig] { return !rig.armed(); }, 1500), 0);
      rig.run_for(3);  // the next sample
      EXPECT_EQ(rig.outputs()[10], 0.0f);
      rig.send(motor_and_servo());
      rig.run_for(600'000);
      rig.arm();
    } else {
      rig.rc.failsafe = true;
      rig.run_for(30);
      ASSERT_TRUE(rig.firmware().state().failsafe());
      EXPECT_EQ(rig.outputs()[10], 0.0f);
      rig.send(motor_and_servo());
      rig.run_for(100);
      EXPECT_EQ(rig.outputs()[10], 0.0f);
      rig.rc.failsafe = false;
      rig.run_for(100);
      ASSERT_FALSE(rig.firmware().state().failsafe());
    }
    EXPECT_EQ(rig.outputs()[10], 0.0f);
    EXPECT_FLOAT_EQ(rig.outputs()[11], 0.75f);
    rig.send(motor_and_servo());
    rig.run_for(10);
    EXPECT_FLOAT_EQ(rig.outputs()[10], 0.8f);
  }
}

TEST(FirmwareSafeguards, NotANumberInAnIgnoredEntryDoesNotDisableTheThrottleStick) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.arm();
  rig.rc.channels[FirmwareRig::kThrottle] = 1.0f;
  link::OffboardControl command;
  command.mode = static_cast<std::uint8_t>(link::OffboardMode::kPassThrough);
  command.ignore = 0x3C0;
  command.u = {0, 0, -0.6f, 0, 0, 0, kNan, kNan, kNan, kNan};
  rig.offboard = command;
  rig.run_for(200);
  ASSERT_NEAR(rig.outputs()[0], 0.6f, 1e-3f);
  rig.rc.channels[FirmwareRig::kThrottle] = 0.0f;
  rig.run_for(100);
  EXPECT_EQ(rig.outputs()[0], 0.1f);  // idle
  EXPECT_NE(rig.firmware().command().override_word() & override_bit::kMinThrottle, 0);
}

TEST(FirmwareSafeguards, LargeIgnoredEntriesDoNotCountAsThrust) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  rig.arm();
  rig.rc.channels[FirmwareRig::kThrottle] = 0.9f;
  link::OffboardControl command;
  command.mode = static_cast<std::uint8_t>(link::OffboardMode::kPassThrough);
  command.ignore = 0x3F8;
  command.u = {0, 0, -0.5f, 1e6f, 1e6f, 1e6f, 1e6f};
  rig.offboard = command;
  rig.run_for(200);
  EXPECT_EQ(rig.firmware().command().override_word() & override_bit::kMinThrottle, 0);
}

TEST(FirmwareSafeguards, WithoutImuMotorsStopAndServosHold) {
  FirmwareRig rig;
  rig.store_quadrotor();
  rig.start();
  link::AuxCommand aux;
  aux.type[8] = static_cast<std::uint8_t>(link::AuxType::kServo);
  aux.value[8] = 0.6f;
  rig.send(aux);
  rig.arm();
  rig.rc.channels[FirmwareRig::kThrottle] = 0.5f;
  rig.run_for(200);
  ASSERT_GT(rig.outputs()[0], 0.3f);
  ASSERT_FLOAT_EQ(rig.outputs()[8], 0.8f);
  rig.imu_on = false;
  rig.run_for(320);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(rig.outputs()[k], 0.0f);
  EXPECT_FLOAT_EQ(rig.outputs()[8], 0.8f);
  rig.imu_on = true;
  rig.run_for(50);
  EXPECT_GT(rig.outputs()[0], 0.3f);
}

/// A medium whose reads fail for a while: a loose card.
class LooseCard final : public hal::Storage {
 public:
  explicit LooseCard(hal::Storage& card) : card_{card} {}
  std::size_t size() const override { return card_.size(); }
  bool read(std::size_t offset, std::uint8_t* data, std::size_t count) override {
    return !loose && card_.read(offset, data, count);
  }
  bool write(std::size_t offset, const std::uint8_t* data, std::size_t count) override {
    return card_.write(offset, data, count);
  }
  bool flush() override { return card_.flush(); }

  bool loose{false};

 private:
  hal::Storage& card_;
};

TEST(FirmwareSafeguards, DefaultsAreNotWrittenOverASetThatCannotBeRead) {
  boards::SimulatedBoard parts;
  boards::MemorySerial serial{16384};
  const hal::Board roles = parts.roles(serial);
  LooseCard card{parts.storage};
  const hal::Board board{roles.clock,         roles.system, roles.serial,  card,
                         roles.backup,        roles.leds,   roles.outputs, roles.receiver,
                         roles.battery,       roles.imu,    roles.mag,     roles.baro,
                         roles.diff_pressure, roles.range,  roles.gnss};
  Parameters stored;
  ASSERT_EQ(stored.set_int(Param::kPrimaryMixer, 2), SetResult::kChanged);
  ASSERT_EQ(ParameterStore(parts.storage).save(stored), StoreResult::kOk);
  const auto before = parts.storage.bytes();
  for (const bool loose : {true, false}) {
    card.loose = loose;
    link::MavlinkCodec codec{{1, link::MavlinkCodec::kFcuComponent}};
    Firmware firmware(board, codec);
    firmware.start();
    EXPECT_EQ(firmware.parameters().get_int(Param::kPrimaryMixer), loose ? 255 : 2);
    EXPECT_EQ(parts.storage.bytes(), before);
  }
}

TEST(FirmwareSafeguards, BlankStorageIsGivenTheDefaults) {
  FirmwareRig rig;
  rig.start();
  Parameters p;
  ParameterStore::LoadReport report;
  EXPECT_EQ(ParameterStore(rig.board.storage).load(p, report), StoreResult::kOk);
  EXPECT_EQ(report.loaded, kParamCount);
}

}  // namespace
}  // namespace rosflight::core
