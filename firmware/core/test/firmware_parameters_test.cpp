// SPDX-License-Identifier: BSD-3-Clause
// The parameter protocol of the whole firmware, and what a change does.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareParameters : public testing::Test {
 protected:
  void start() {
    rig_.store_quadrotor();
    rig_.start();
    rig_.run_for(500);
    rig_.inbox.clear();
  }
  float value(Param id) const { return rig_.firmware().parameters().get_float(id); }
  std::int32_t number(Param id) const { return rig_.firmware().parameters().get_int(id); }

  FirmwareRig rig_;
};

// ---- setting (weak point 59: equal values, wrong types and unknown names got no answer)

TEST_F(FirmwareParameters, AChangeIsEchoedOnceInTheSamePass) {
  start();
  rig_.set_param("RC_MAX_THR", 0.6f);
  rig_.pass();
  ASSERT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
  const auto echo = rig_.values_of("RC_MAX_THR")[0];
  EXPECT_EQ(echo.value.bits, bits_of(0.6f));
  EXPECT_EQ(echo.type, ParamType::kFloat);
  EXPECT_EQ(echo.count, 333);
  EXPECT_EQ(echo.index, static_cast<std::uint16_t>(Param::kRcMaxThr));
  rig_.run_for(200);
  EXPECT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
}

TEST_F(FirmwareParameters, AnEqualValueIsEchoed) {
  start();
  rig_.set_param("RC_MAX_THR", 0.7f);
  rig_.pass();
  EXPECT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
}

TEST_F(FirmwareParameters, AWrongTypeIsToldAndTheKeptValueEchoed) {
  start();
  for (int type = 0; type < 256; ++type) {
    if (type == 9) continue;
    rig_.inbox.clear();
    rig_.send(link::ParamSet{
        1, param_name("RC_MAX_THR"), {bits_of(0.5f)}, static_cast<std::uint8_t>(type)});
    rig_.pass();
    ASSERT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u) << type;
    ASSERT_EQ(rig_.values_of("RC_MAX_THR")[0].value.bits, bits_of(0.7f)) << type;
    rig_.run_for(20);
    ASSERT_TRUE(rig_.said("Wrong type, kept: RC_MAX_THR")) << type;
  }
}

TEST_F(FirmwareParameters, OutOfRangeIsToldAndTheKeptValueEchoed) {  // weak point 64
  start();
  for (const float bad : {1.01f, -0.01f, std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity()}) {
    rig_.inbox.clear();
    rig_.set_param("RC_MAX_THR", bad);
    rig_.run_for(20);
    ASSERT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u) << bad;
    EXPECT_EQ(rig_.values_of("RC_MAX_THR")[0].value.bits, bits_of(0.7f)) << bad;
    EXPECT_TRUE(rig_.said("Out of range, kept: RC_MAX_THR")) << bad;
  }
}

TEST_F(FirmwareParameters, AnUnknownNameIsToldWithoutAValue) {
  start();
  rig_.set_param("NO_SUCH_NAME", 1);
  rig_.set_param("PID_PITCH_RATE_X", 1.0f);  // 16 characters, no NUL
  rig_.run_for(20);
  EXPECT_TRUE(rig_.got<link::ParamValue>().empty());
  EXPECT_TRUE(rig_.said("No parameter NO_SUCH_NAME"));
  EXPECT_TRUE(rig_.said("No parameter PID_PITCH_RATE_X"));
}

TEST_F(FirmwareParameters, OtherSystemsAreNotAnsweredTheBroadcastAddressIs) {
  start();
  for (const std::uint8_t target : {std::uint8_t{2}, std::uint8_t{42}, std::uint8_t{255}}) {
    rig_.send(link::ParamSet{target, param_name("RC_MAX_THR"), {bits_of(0.5f)}, 9});
    rig_.send(link::ParamRequestRead{target, 3, {}});
    rig_.send(link::ParamRequestList{target});
  }
  rig_.run_for(200);
  EXPECT_TRUE(rig_.got<link::ParamValue>().empty());
  EXPECT_FLOAT_EQ(value(Param::kRcMaxThr), 0.7f);
  rig_.send(link::ParamRequestRead{0, 3, {}});
  rig_.pass();
  EXPECT_EQ(rig_.got<link::ParamValue>().size(), 1u);
}

TEST_F(FirmwareParameters, ANameOfSixteenCharactersIsFound) {
  start();
  rig_.set_param("PID_PITCH_RATE_P", 0.08f);
  rig_.run_for(20);
  EXPECT_FLOAT_EQ(value(Param::kPidPitchRateP), 0.08f);
}

TEST_F(FirmwareParameters, GarbageInANameIsSurvived) {
  start();
  link::ParamName garbage{};
  garbage.fill(static_cast<char>(0xFF));
  rig_.send(link::ParamSet{1, garbage, {0xFFFFFFFFu}, 9});
  rig_.send(link::ParamSet{1, {}, {0}, 6});
  rig_.run_for(50);
  EXPECT_TRUE(rig_.got<link::ParamValue>().empty());
}

// ---- locked while armed (weak point 18)

TEST_F(FirmwareParameters, WhatCouldTurnTheAircraftOverIsLockedWhileArmed) {
  start();
  rig_.arm();
  rig_.set_param("PRIMARY_MIXER", 1);
  rig_.set_param("FIXED_WING", 1);
  rig_.set_param("PRI_MIXER_OUT_0", 1);
  rig_.set_param("RC_F_AXIS", 0);
  rig_.set_param("IMU_ROLL", 180.0f);
  rig_.run_for(100);
  EXPECT_EQ(number(Param::kPrimaryMixer), 2);
  EXPECT_EQ(number(Param::kFixedWing), 0);
  EXPECT_EQ(number(Param::kRcFAxis), 2);
  EXPECT_EQ(value(Param::kImuRoll), 0.0f);
  ASSERT_EQ(rig_.values_of("PRIMARY_MIXER").size(), 1u);
  EXPECT_EQ(rig_.values_of("PRIMARY_MIXER")[0].value.bits, 2u);
  EXPECT_TRUE(rig_.said("Not while armed, kept: PRIMARY_MIXER"));
  EXPECT_FALSE(rig_.values_of("RC_F_AXIS").empty());
}

TEST_F(FirmwareParameters, GainsMayBeTunedInFlight) {
  start();
  rig_.arm();
  rig_.set_param("PID_ROLL_ANG_P", 0.2f);
  rig_.run_for(20);
  EXPECT_FLOAT_EQ(value(Param::kPidRollAngP), 0.2f);
  EXPECT_TRUE(rig_.armed());
}

// ---- reading and listing

TEST_F(FirmwareParameters, OneIsReadByIndexOrByName) {
  start();
  rig_.send(link::ParamRequestRead{1, 231, {}});
  rig_.pass();
  ASSERT_EQ(rig_.values_of("SYS_ID").size(), 1u);
  EXPECT_EQ(rig_.values_of("SYS_ID")[0].value.bits, 1u);
  EXPECT_EQ(rig_.values_of("SYS_ID")[0].type, ParamType::kInt32);
  rig_.send(link::ParamRequestRead{1, -1, param_name("MOTOR_RESISTANCE")});
  rig_.pass();
  EXPECT_EQ(rig_.values_of("MOTOR_RESISTANCE").size(), 1u);
}

TEST_F(FirmwareParameters, IndicesPastTheEndAreNotAnswered) {
  start();
  for (const int index : {333, 334, 1000, 32767}) {
    rig_.send(link::ParamRequestRead{1, static_cast<std::int16_t>(index), {}});
  }
  rig_.run_for(50);
  EXPECT_TRUE(rig_.got<link::ParamValue>().empty());
}

// Weak points 60 and 75.
TEST_F(FirmwareParameters, AListStartsAtOnceComesInOrderAndNeverChangesItsCount) {
  start();
  rig_.send(link::ParamRequestList{});
  rig_.pass();
  ASSERT_FALSE(rig_.got<link::ParamValue>().empty()) << "in the same pass";
  rig_.run_for(1000);
  const auto values = rig_.got<link::ParamValue>();
  ASSERT_EQ(values.size(), 333u);
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(values[k].index, k);
    EXPECT_EQ(values[k].count, 333);
  }
}

TEST_F(FirmwareParameters, AListLeavesTheLineToTheSensors) {
  start();
  rig_.send(link::ParamRequestList{});
  for (int k = 0; k < 100; ++k) {
    rig_.inbox.clear();
    rig_.pass();
    EXPECT_EQ(rig_.got<link::Imu>().size(), 1u);
    EXPECT_LE(rig_.got<link::ParamValue>().size(), 2u);
  }
}

TEST(FirmwareParametersOnASlowLine, AListWaitsForRoomAndLosesNothing) {
  // A queue that holds two passes' streams and that nobody empties for 19 passes out of 20.
  boards::SimulatedBoard board;
  boards::MemorySerial serial{600};
  link::MavlinkCodec fcu{{1, 250}}, companion{{1, 50}};
  Firmware firmware(board.roles(serial), fcu);
  firmware.start();
  link::Frame frame;
  ASSERT_TRUE(companion.encode(link::ParamRequestList{}, frame));
  serial.put(frame.bytes.data(), frame.size);
  std::set<std::uint16_t> seen;
  for (int k = 1; k <= 20 * 400; ++k) {
    board.clock.set(hal::microseconds(std::int64_t{2500} * k));
    firmware.run();
    if (k % 20 != 0) continue;
    const auto bytes = serial.take_sent();
    for (std::size_t used = 0; used < bytes.size();) {
      const auto result = companion.decode(bytes.data() + used, bytes.size() - used);
      used += result.consumed;
      if (!result.complete) continue;
      if (const auto* v = std::get_if<link::ParamValue>(&companion.message()))
        seen.insert(v->index);
    }
  }
  EXPECT_EQ(seen.size(), 333u);
}

TEST_F(FirmwareParameters, AListRestartsWhenAskedAgain) {
  start();
  rig_.send(link::ParamRequestList{});
  rig_.run_for(100);
  rig_.inbox.clear();
  rig_.send(link::ParamRequestList{});
  rig_.pass();
  ASSERT_FALSE(rig_.got<link::ParamValue>().empty());
  EXPECT_EQ(rig_.got<link::ParamValue>()[0].index, 0);
}

// Weak point 60: 83 values in one pass.
TEST_F(FirmwareParameters, AMixerSelectionIsToldPacedAndComplete) {
  rig_.start();
  rig_.run_for(2000);
  rig_.inbox.clear();
  rig_.set_param("PRIMARY_MIXER", 6);
  std::set<std::string> told;
  for (int k = 0; k < 100; ++k) {
    rig_.inbox.clear();
    rig_.pass();
    EXPECT_LE(rig_.got<link::ParamValue>().size(), 3u) << "the echo and two more";
    for (const auto& v : rig_.got<link::ParamValue>()) told.insert(to_string(v.name));
  }
  EXPECT_EQ(told.size(), 83u);  // reference run: octocopter X from defaults
  EXPECT_EQ(told.count("PRIMARY_MIXER"), 1u);
}

// ---- commands 5, 6, 7 (weak point 62: neither modules nor companion were told)

TEST_F(FirmwareParameters, WriteReadAndDefaultsAreToldToModulesAndCompanion) {
  start();
  rig_.set_param("RC_MAX_THR", 0.5f);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(50);
  ASSERT_TRUE(rig_.got<link::CommandAck>().back().success);
  rig_.inbox.clear();

  rig_.command(link::Command::kSetParamDefaults);
  rig_.run_for(500);
  EXPECT_TRUE(rig_.got<link::CommandAck>().back().success);
  EXPECT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
  EXPECT_EQ(rig_.values_of("PRIMARY_MIXER").size(), 1u);
  EXPECT_FLOAT_EQ(value(Param::kRcMaxThr), 0.7f);
  EXPECT_EQ(rig_.errors(), 0xA1) << "the modules follow: no mixer, no failsafe, no biases";
  rig_.inbox.clear();

  rig_.command(link::Command::kReadParams);
  rig_.run_for(500);
  EXPECT_TRUE(rig_.got<link::CommandAck>().back().success);
  EXPECT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
  EXPECT_FLOAT_EQ(value(Param::kRcMaxThr), 0.5f);
  EXPECT_EQ(number(Param::kPrimaryMixer), 2);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareParameters, AFailedReadLeavesTheLiveTableAlone) {
  start();
  rig_.set_param("RC_MAX_THR", 0.5f);
  rig_.run_for(10);
  rig_.board.storage.set_bytes(std::vector<std::uint8_t>(16384, 0x5A));
  rig_.command(link::Command::kReadParams);
  rig_.run_for(50);
  EXPECT_FALSE(rig_.got<link::CommandAck>().back().success);
  EXPECT_FLOAT_EQ(value(Param::kRcMaxThr), 0.5f);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareParameters, AFailedWriteIsRefusedAndTold) {
  start();
  rig_.board.storage.cut_power_after(0);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(50);
  EXPECT_FALSE(rig_.got<link::CommandAck>().back().success);
  EXPECT_TRUE(rig_.said("Parameters not saved: storage failed"));
}

TEST_F(FirmwareParameters, ChangesAreGoneAfterARestartUnlessWritten) {
  start();
  rig_.set_param("RC_MAX_ROLL", 0.5f);
  rig_.run_for(10);
  FirmwareRig again;
  again.board.storage.set_bytes(rig_.board.storage.bytes());
  again.start();
  EXPECT_FLOAT_EQ(again.firmware().parameters().get_float(Param::kRcMaxRoll), 0.786f);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(10);
  FirmwareRig third;
  third.board.storage.set_bytes(rig_.board.storage.bytes());
  third.start();
  EXPECT_FLOAT_EQ(third.firmware().parameters().get_float(Param::kRcMaxRoll), 0.5f);
}

TEST_F(FirmwareParameters, ABlankStorageIsFilledWithTheDefaults) {
  rig_.start();
  FirmwareRig again;
  again.board.storage.set_bytes(rig_.board.storage.bytes());
  again.start();
  again.run_for(1000);
  EXPECT_FALSE(again.said("Unable to load parameters, using defaults"));
}

// ---- reactions

TEST_F(FirmwareParameters, BiasesLoadedFromAFileClearTheCalibrationError) {  // weak point 36
  rig_.start();
  rig_.run_for(100);
  ASSERT_EQ(rig_.errors() & 0x20, 0x20);
  rig_.set_param("ACC_Z_BIAS", 0.1f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors() & 0x20, 0);
  rig_.set_param("ACC_Z_BIAS", 0.0f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors() & 0x20, 0x20);
}

TEST_F(FirmwareParameters, FailsafeThrottleSetsAndClearsItsError) {
  start();
  rig_.set_param("FAILSAFE_THR", -1.0f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0x80);
  rig_.set_param("FIXED_WING", 1);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0);
  rig_.set_param("FIXED_WING", 0);
  rig_.set_param("FAILSAFE_THR", 0.0f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.errors(), 0);
}

TEST_F(FirmwareParameters, APulseRateReachesTheBoardWithoutARestart) {  // weak point 45
  rig_.start();
  rig_.run_for(100);
  rig_.set_param("PRIMARY_MIXER", 11);
  rig_.set_param("PRI_MIXER_OUT_0", 2);
  rig_.set_param("PRI_MIXER_PWM_0", 400.0f);
  rig_.run_for(10);
  EXPECT_EQ(rig_.board.outputs.rates_hz()[0], 400.0f);
  EXPECT_EQ(rig_.board.outputs.rates_hz()[1], 50.0f) << "unset means 50 Hz (weak point 46)";
}

TEST_F(FirmwareParameters, ARateTheBoardCannotGiveIsTold) {  // weak point 55
  start();
  rig_.set_param("PRI_MIXER_PWM_3", 1000.0f);
  rig_.run_for(20);
  EXPECT_TRUE(rig_.said("PRI_MIXER_PWM: board cannot give all rates"));
}

TEST_F(FirmwareParameters, AChangedSwitchMappingIsTold) {
  start();
  rig_.set_param("RC_ARM_CHN", 5);
  rig_.run_for(50);
  EXPECT_TRUE(rig_.said("arm switch on channel 5"));
}

TEST_F(FirmwareParameters, BatteryScaleOneLeavesTheBoardItsOwn) {  // weak point 30
  rig_.board.battery.set_multipliers(11.0f, 5.0f);
  start();
  rig_.board.battery.put({rig_.now(), 1.5f, 1.0f});
  rig_.pass();
  EXPECT_FLOAT_EQ(rig_.got<link::BatteryStatus>().at(0).voltage_V, 16.5f);
  rig_.set_param("BATT_VOLT_LPF", 0.0f);
  rig_.set_param("BATT_VOLT_MULT", 2.0f);
  rig_.run_for(10);
  rig_.board.battery.put({rig_.now(), 1.5f, 1.0f});
  rig_.pass();
  EXPECT_FLOAT_EQ(rig_.got<link::BatteryStatus>().back().voltage_V, 3.0f);
}

// ---- boards that lack something (weak point 73)

class PickyReceiver final : public hal::Receiver {
 public:
  bool poll(hal::RcFrame& /*frame*/) override { return false; }
  bool start(hal::ReceiverType type) override { return type == hal::ReceiverType::kSbus; }
};

class DeafSerial final : public hal::Serial {
 public:
  bool open(std::uint32_t /*baud*/, std::uint8_t /*device*/) override { return false; }
  bool write(const std::uint8_t* /*data*/, std::size_t /*size*/, std::uint8_t /*qos*/) override {
    return false;
  }
  std::size_t writable() const override { return 0; }
  std::size_t read(std::uint8_t* /*data*/, std::size_t /*capacity*/) override { return 0; }
};

std::vector<std::string> drain(Firmware& firmware) {
  std::vector<std::string> lines;
  Log log = firmware.log();
  while (!log.empty()) lines.emplace_back(log.pop().text.data());
  return lines;
}

TEST(FirmwareOnAnotherBoard, ReceiverAndSerialThatItLacksAreTold) {
  boards::SimulatedBoard board;
  PickyReceiver receiver;
  DeafSerial serial;
  const hal::Board all = board.roles(serial);
  const hal::Board roles{all.clock, all.system,  all.serial,        all.storage, all.backup,
                         all.leds,  all.outputs, receiver,          all.battery, all.imu,
                         all.mag,   all.baro,    all.diff_pressure, all.range,   all.gnss};
  link::MavlinkCodec codec{{1, 250}};
  Firmware firmware(roles, codec);
  firmware.start();
  const auto lines = drain(firmware);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "RC_TYPE: this board has no such receiver"), 1);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "SERIAL_DEVICE, BAUD_RATE: board uses its own"),
            1);
  for (int k = 0; k < 1000; ++k) firmware.run();  // nothing can be sent, nothing happens
  EXPECT_EQ(firmware.state().errors(), 0xA1);
}

}  // namespace
}  // namespace rosflight::core
