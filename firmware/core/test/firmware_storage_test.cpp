// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/firmware_parameters_rig.hpp"

namespace rosflight::core {
namespace {

// ---- commands 5, 6, 7 (weak point 62: neither modules nor companion were notified)

TEST_F(FirmwareParameters, WriteReadAndDefaultsAreToldToModulesAndCompanion) {
  start();
  rig_.set_param("RC_MAX_THR", 0.5f);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(500);
  ASSERT_FALSE(rig_.got<link::CommandAck>().empty());
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

TEST_F(FirmwareParameters, AWriteTakesOneBlockAPassAndIsAcknowledgedWhenItIsDone) {
  start();
  rig_.run_for(100);
  rig_.set_param("RC_MAX_THR", 0.5f);
  rig_.run_for(10);
  rig_.command(link::Command::kWriteParams);
  int passes = 0;
  while (rig_.got<link::CommandAck>().empty()) {
    const auto before = rig_.board.storage.bytes();
    rig_.pass();
    const auto& after = rig_.board.storage.bytes();
    std::size_t first = before.size();
    std::size_t last = 0;
    for (std::size_t k = 0; k < before.size(); ++k) {
      if (before[k] == after[k]) continue;
      first = std::min(first, k);
      last = k;
    }
    EXPECT_TRUE(first > last || last - first < ParameterStore::kBlockBytes);
    ASSERT_LT(++passes, 200);
  }
  EXPECT_GT(passes, 100);
  EXPECT_TRUE(rig_.got<link::CommandAck>()[0].success);
  EXPECT_FALSE(rig_.firmware().parameters().unsaved());
  rig_.run_for(500);
  EXPECT_EQ(rig_.got<link::CommandAck>().size(), 1u);
}

TEST_F(FirmwareParameters, AChangeDuringAWriteStaysUnsavedAndASecondWriteCoversIt) {
  start();
  rig_.run_for(100);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(200);
  rig_.set_param("RC_MAX_THR", 0.5f);
  rig_.set_param("BAUD_RATE", 57600);
  rig_.run_for(200);
  ASSERT_EQ(rig_.got<link::CommandAck>().size(), 1u);
  EXPECT_TRUE(rig_.firmware().parameters().unsaved());

  rig_.command(link::Command::kWriteParams);
  rig_.run_for(100);
  rig_.set_param("BAUD_RATE", 115200);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(1000);
  ASSERT_EQ(rig_.got<link::CommandAck>().size(), 3u);
  EXPECT_FALSE(rig_.firmware().parameters().unsaved());
  FirmwareRig again;
  again.board.storage.set_bytes(rig_.board.storage.bytes());
  again.start();
  EXPECT_EQ(again.firmware().parameters().get_int(Param::kBaudRate), 115200);
}

TEST_F(FirmwareParameters, AReadDuringAWriteIsRefusedAndARebootWaitsForItsEnd) {
  start();
  rig_.run_for(100);
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(20);
  rig_.command(link::Command::kReadParams);
  rig_.command(link::Command::kReboot);
  rig_.run_for(100);
  ASSERT_EQ(rig_.got<link::CommandAck>().size(), 2u);
  EXPECT_FALSE(rig_.got<link::CommandAck>()[0].success);
  EXPECT_FALSE(rig_.board.system.reset_requested());
  rig_.run_for(400);
  EXPECT_TRUE(rig_.board.system.reset_requested());
  FirmwareRig again;
  again.board.storage.set_bytes(rig_.board.storage.bytes());
  again.start();
  again.run_for(1100);
  EXPECT_FALSE(again.said("Newer parameters damaged: older set in force"));
}

TEST_F(FirmwareParameters, AnOlderSetInForceIsToldAndRefusesArmingUntilTheParametersAreWritten) {
  rig_.store_quadrotor();
  rig_.store(
      [](Parameters& p) { ASSERT_NE(p.set_int(Param::kNumMotors, 6), SetResult::kWrongType); });
  auto bytes = rig_.board.storage.bytes();
  bytes[bytes.size() / 2 + 1000] ^= 1u;  // the second save went there
  rig_.board.storage.set_bytes(bytes);
  rig_.start();
  rig_.run_for(1100);
  EXPECT_TRUE(rig_.said("Newer parameters damaged: older set in force"));
  EXPECT_EQ(number(Param::kNumMotors), 4);
  EXPECT_EQ(rig_.board.storage.bytes(), bytes) << "nothing is written unasked";
  rig_.hold_arming_corner();
  rig_.run_for(1500);
  EXPECT_FALSE(rig_.armed());
  rig_.release();
  rig_.command(link::Command::kWriteParams);
  rig_.run_for(500);
  rig_.hold_arming_corner();
  rig_.run_for(1500);
  EXPECT_TRUE(rig_.armed());
}

TEST_F(FirmwareParameters, ADamagedStorageIsToldAndNeverWrittenUnasked) {
  const std::vector<std::uint8_t> garbage(16384, 0x5A);
  rig_.board.storage.set_bytes(garbage);
  rig_.start();
  rig_.run_for(1100);
  EXPECT_TRUE(rig_.said("Stored parameters damaged, not overwritten"));
  EXPECT_EQ(rig_.board.storage.bytes(), garbage);
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
  rig_.run_for(500);
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

}  // namespace
}  // namespace rosflight::core
