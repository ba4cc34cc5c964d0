// SPDX-License-Identifier: BSD-3-Clause
// The parameter protocol of the whole firmware, and what a change does.
#include "firmware/core/test/firmware_parameters_rig.hpp"

namespace rosflight::core {
namespace {

// ---- setting (weak point 59: equal values, wrong types and unknown names got no answer)

TEST_F(FirmwareParameters, AChangeIsEchoedOnceInTheSamePass) {
  start();
  rig_.set_param("RC_MAX_THR", 0.6f);
  rig_.pass();
  ASSERT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
  const auto echo = rig_.values_of("RC_MAX_THR")[0];
  EXPECT_EQ(echo.value.bits, bits_of(0.6f));
  EXPECT_EQ(echo.type, ParamType::kFloat);
  EXPECT_EQ(echo.count, kParamCount);
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

TEST_F(FirmwareParameters, OneMessageInFlightGoesNoFurtherThanItsRuleAndIsAnsweredWithTheKept) {
  start();
  rig_.arm();
  rig_.set_param("PID_ROLL_ANG_P", 0.61f);
  rig_.set_param("PID_PITCH_ANG_P", 0.0f);
  rig_.set_param("RC_MAX_THR", 0.0f);
  rig_.run_for(20);
  EXPECT_EQ(value(Param::kPidRollAngP), 0.15f);
  EXPECT_EQ(value(Param::kPidPitchAngP), 0.15f);
  EXPECT_EQ(value(Param::kRcMaxThr), 0.7f);
  EXPECT_TRUE(rig_.said("Not that far while armed, kept: PID_ROLL_ANG_P"));
  EXPECT_TRUE(rig_.said("Not that far while armed, kept: RC_MAX_THR"));
  ASSERT_EQ(rig_.values_of("RC_MAX_THR").size(), 1u);
  EXPECT_EQ(rig_.values_of("RC_MAX_THR")[0].value.bits, bits_of(0.7f));
}

TEST_F(FirmwareParameters, NothingThatHoldsTheAttitudeTogetherChangesInFlight) {
  start();
  rig_.arm();
  const auto before = rig_.firmware().parameters();
  for (const char* name : {"GYRO_X_BIAS", "ACC_Z_BIAS", "GYRO_XY_LPF", "ACC_LPF", "FILT_ACC_KP",
                           "PID_TAU", "RC_ARM_THRESHOLD", "MOTOR_IDLE_THR", "PRI_MIXER_0_0"}) {
    rig_.set_param(name, 1.0f);
    rig_.set_param(name, 0.0f);
  }
  rig_.set_param("ARM_SPIN_MOTORS", 0);
  rig_.run_for(100);
  for (std::size_t k = 0; k < kParamCount; ++k) {
    const auto id = static_cast<Param>(k);
    EXPECT_EQ(rig_.firmware().parameters().bits(id), before.bits(id)) << k;
  }
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
  constexpr int kEnd = static_cast<int>(kParamCount);
  for (const int index : {kEnd, kEnd + 1, 1000, 32767}) {
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
  rig_.run_for(1200);
  const auto values = rig_.got<link::ParamValue>();
  ASSERT_EQ(values.size(), kParamCount);
  for (std::size_t k = 0; k < values.size(); ++k) {
    EXPECT_EQ(values[k].index, k);
    EXPECT_EQ(values[k].count, kParamCount);
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
  EXPECT_EQ(seen.size(), kParamCount);
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
  for (int k = 0; k < 130; ++k) {
    rig_.inbox.clear();
    rig_.pass();
    EXPECT_LE(rig_.got<link::ParamValue>().size(), 3u) << "the echo and two more";
    for (const auto& v : rig_.got<link::ParamValue>()) told.insert(to_string(v.name));
  }
  EXPECT_EQ(told.size(), 83u);  // reference run: octocopter X from defaults
  EXPECT_EQ(told.count("PRIMARY_MIXER"), 1u);
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

/// Volts and amperes that the companion receives for 1.5 V and 1 A at the pins.
std::pair<float, float> battery_of(FirmwareRig& rig) {
  rig.run_for(10);
  rig.inbox.clear();
  rig.board.battery.put({rig.now(), 1.5f, 1.0f});
  rig.pass();
  const auto status = rig.got<link::BatteryStatus>();
  return status.empty() ? std::pair{-1.0f, -1.0f}
                        : std::pair{status.back().voltage_V, status.back().current_A};
}
void store_unfiltered_battery(FirmwareRig& rig) {
  rig.board.battery.set_multipliers(11.0f, 5.0f);
  rig.store([](Parameters& p) {
    ASSERT_EQ(p.set_float(Param::kBattVoltLpf, 0.0f), SetResult::kChanged);
    ASSERT_EQ(p.set_float(Param::kBattCurrLpf, 0.0f), SetResult::kChanged);
  });
}

TEST_F(FirmwareParameters, BatteryScalesThatNobodySetAreTheBoardsOwn) {  // weak point 30
  store_unfiltered_battery(rig_);
  rig_.start();
  EXPECT_EQ(battery_of(rig_), std::pair(16.5f, 5.0f));
  EXPECT_EQ(number(Param::kBattMultSet), 0);
}

TEST_F(FirmwareParameters, ABatteryScaleThatIsSetIsMeantAlsoIfItIsOne) {
  store_unfiltered_battery(rig_);
  rig_.start();
  rig_.set_param("BATT_VOLT_MULT", 2.0f);
  EXPECT_EQ(battery_of(rig_), std::pair(3.0f, 5.0f));
  rig_.set_param("BATT_VOLT_MULT", 1.0f);
  EXPECT_EQ(battery_of(rig_), std::pair(1.5f, 5.0f));
  EXPECT_EQ(number(Param::kBattMultSet), 1);
  rig_.set_param("BATT_CURR_MULT", 1.0f);  // the value it has
  EXPECT_EQ(battery_of(rig_), std::pair(1.5f, 1.0f));
  EXPECT_EQ(number(Param::kBattMultSet), 3);
}

TEST_F(FirmwareParameters, ABatteryScaleOfOneOutlivesARestartAndEndsWithTheDefaults) {
  store_unfiltered_battery(rig_);
  rig_.start();
  rig_.set_param("BATT_VOLT_MULT", 1.0f);
  rig_.run_for(10);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(500);
  FirmwareRig again;
  again.board.battery.set_multipliers(11.0f, 5.0f);
  again.board.storage.set_bytes(rig_.board.storage.bytes());
  again.start();
  EXPECT_EQ(battery_of(again), std::pair(1.5f, 5.0f));
  again.command(link::Command::kSetParamDefaults);
  again.run_for(10);
  again.command(link::Command::kWriteParams);
  again.run_for(500);
  FirmwareRig third;
  third.board.battery.set_multipliers(11.0f, 5.0f);
  third.board.storage.set_bytes(again.board.storage.bytes());
  third.start();
  EXPECT_EQ(third.firmware().parameters().get_int(Param::kBattMultSet), 0);
  EXPECT_EQ(battery_of(third), std::pair(16.5f, 5.0f));
}

TEST_F(FirmwareParameters, ABatteryScaleThatIsRefusedChoosesNothing) {
  store_unfiltered_battery(rig_);
  start();
  rig_.set_param("BATT_VOLT_MULT", -1.0f);
  rig_.set_param("BATT_CURR_MULT", 1);  // the wrong type
  rig_.arm();
  rig_.set_param("BATT_VOLT_MULT", 1.0f);  // the value it has, but in flight
  EXPECT_EQ(battery_of(rig_), std::pair(16.5f, 5.0f));
  EXPECT_EQ(number(Param::kBattMultSet), 0);
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
