// SPDX-License-Identifier: BSD-3-Clause
// Restart after a fault: the record in backup memory, rearming, the report.
#include <memory>
#include <vector>

#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

class FirmwareCrash : public testing::Test {
 protected:
  void fly_quadrotor() {
    rig_.store_quadrotor();
    rig_.start();
    rig_.arm();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    rig_.run_for(100);
    ASSERT_EQ(rig_.errors(), 0);
  }
  /// A second life on the same backup memory and storage.
  void crash_and_restart(FirmwareRig& after, std::size_t spoil = CrashRecord::kBytes) {
    rig_.firmware().record_fault({1, 2, 3, 4, 5, 6, 0x08001234, 8});
    std::array<std::uint8_t, CrashRecord::kBytes> record{};
    ASSERT_TRUE(rig_.board.backup.read(record.data(), record.size()));
    if (spoil < record.size()) record[spoil] = static_cast<std::uint8_t>(record[spoil] ^ 1u);
    ASSERT_TRUE(after.board.backup.write(record.data(), record.size()));
    after.board.storage.set_bytes(rig_.board.storage.bytes());
    after.start();
  }

  FirmwareRig rig_;
};

TEST_F(FirmwareCrash, ArmedBeforeMeansArmedAtOnceAndAReport) {
  fly_quadrotor();
  FirmwareRig after;
  crash_and_restart(after);
  EXPECT_TRUE(after.armed());
  after.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  after.run_for(100);
  EXPECT_TRUE(after.armed());
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(after.outputs()[k], 0.56f, 1e-3f);
  const auto report = after.got<link::HardError>();
  ASSERT_EQ(report.size(), 1u) << "with the first heartbeat, once";
  EXPECT_EQ(report[0].error_code, 0u);
  EXPECT_EQ(report[0].pc, 0x08001234u);
  EXPECT_EQ(report[0].reset_count, 1u);
  EXPECT_EQ(report[0].rearm, 1u);
  after.run_for(500);
  EXPECT_TRUE(after.said("Rearmed after a fault in flight"));
  EXPECT_TRUE(after.said("Fault 1 at pc 0x8001234"));
  for (const auto& t : after.got<link::StatusText>()) {
    if (std::string(t.text.data()).find("ault ") != std::string::npos) {
      EXPECT_EQ(t.severity, link::Severity::kCritical) << t.text.data();
    }
  }
  after.run_for(1000);
  EXPECT_EQ(after.got<link::HardError>().size(), 1u);
}

TEST_F(FirmwareCrash, TheMemoryIsClearedSoThatAThirdLifeIsCold) {
  fly_quadrotor();
  FirmwareRig after;
  crash_and_restart(after);
  FirmwareRig third;
  std::array<std::uint8_t, CrashRecord::kBytes> record{};
  ASSERT_TRUE(after.board.backup.read(record.data(), record.size()));
  EXPECT_EQ(record, (std::array<std::uint8_t, CrashRecord::kBytes>{}));
}

TEST_F(FirmwareCrash, FaultsAreCountedOverLives) {
  fly_quadrotor();
  FirmwareRig after;
  crash_and_restart(after);
  after.firmware().record_fault({});
  std::array<std::uint8_t, CrashRecord::kBytes> record{};
  ASSERT_TRUE(after.board.backup.read(record.data(), record.size()));
  EXPECT_EQ(record[0], 2);
}

TEST_F(FirmwareCrash, AtIdleOnTheGroundItIsNotRearmed) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.arm();
  rig_.run_for(1000);
  FirmwareRig after;
  crash_and_restart(after);
  EXPECT_FALSE(after.armed());
  EXPECT_EQ(after.firmware().state().state(), State::kPreflight);
  after.run_for(500);
  EXPECT_TRUE(after.said("Fault at idle: not rearmed"));
  EXPECT_EQ(after.got<link::HardError>().at(0).rearm, 0u);
}

TEST_F(FirmwareCrash, AFixedWingThatGlidesIsRearmedForHalfAMinute) {
  for (const int gliding_ms : {3'000, 29'000, 31'000}) {
    FirmwareRig before;
    before.store_airplane();
    before.start();
    before.arm();
    before.rc.channels[FirmwareRig::kThrottle] = 0.6f;
    before.run_for(1000);
    before.rc.channels[FirmwareRig::kThrottle] = 0.0f;
    before.run_for(gliding_ms);
    ASSERT_TRUE(before.armed());
    before.firmware().record_fault({});
    FirmwareRig after;
    std::array<std::uint8_t, CrashRecord::kBytes> record{};
    ASSERT_TRUE(before.board.backup.read(record.data(), record.size()));
    ASSERT_TRUE(after.board.backup.write(record.data(), record.size()));
    after.board.storage.set_bytes(before.board.storage.bytes());
    after.start();
    EXPECT_EQ(after.armed(), gliding_ms < 30'000) << gliding_ms;
  }
}

TEST_F(FirmwareCrash, ARestartOnTheGroundInBetweenDoesNotForgetTheRearmings) {
  fly_quadrotor();
  std::vector<std::unique_ptr<FirmwareRig>> lives;
  FirmwareRig* life = &rig_;
  const auto fault = [&](float throttle) {
    life->rc.channels[FirmwareRig::kThrottle] = throttle;
    life->run_for(1000);
    life->firmware().record_fault({});
    auto next = std::make_unique<FirmwareRig>();
    std::array<std::uint8_t, CrashRecord::kBytes> record{};
    ASSERT_TRUE(life->board.backup.read(record.data(), record.size()));
    ASSERT_TRUE(next->board.backup.write(record.data(), record.size()));
    next->board.storage.set_bytes(life->board.storage.bytes());
    next->start();
    lives.push_back(std::move(next));
    life = lives.back().get();
  };
  fault(0.8f);
  fault(0.8f);
  ASSERT_TRUE(life->armed());
  fault(0.0f);  // at idle: it has landed
  ASSERT_FALSE(life->armed());
  life->run_for(700);
  life->arm();
  fault(0.8f);
  ASSERT_TRUE(life->armed()) << "the third within the minute";
  fault(0.8f);
  EXPECT_FALSE(life->armed()) << "the fourth";
}

TEST_F(FirmwareCrash, TheFourthFaultWithinAMinuteIsNotRearmed) {
  fly_quadrotor();
  std::vector<std::unique_ptr<FirmwareRig>> lives;
  const auto next_life = [&](FirmwareRig& before, std::int64_t ms) -> FirmwareRig& {
    before.rc.channels[FirmwareRig::kThrottle] = 0.8f;
    before.run_for(ms);
    before.firmware().record_fault({});
    lives.push_back(std::make_unique<FirmwareRig>());
    std::array<std::uint8_t, CrashRecord::kBytes> record{};
    EXPECT_TRUE(before.board.backup.read(record.data(), record.size()));
    EXPECT_TRUE(lives.back()->board.backup.write(record.data(), record.size()));
    lives.back()->board.storage.set_bytes(before.board.storage.bytes());
    lives.back()->start();
    return *lives.back();
  };
  FirmwareRig* life = &rig_;
  for (int fault = 1; fault <= 3; ++fault) {
    life = &next_life(*life, 5000);
    ASSERT_TRUE(life->armed()) << "fault " << fault;
  }
  FirmwareRig& slow = next_life(*life, 55'000);  // the first rearming is 65 s ago
  ASSERT_TRUE(slow.armed());
  life = &next_life(slow, 1000);
  ASSERT_TRUE(life->armed()) << "two within the last 60 s";
  life = &next_life(*life, 1000);
  EXPECT_FALSE(life->armed()) << "55, 1 and 1 s ago: three";
  EXPECT_EQ(life->firmware().state().state(), State::kPreflight);
}

TEST_F(FirmwareCrash, DisarmedBeforeMeansAReportOnly) {
  rig_.store_quadrotor();
  rig_.start();
  rig_.run_for(100);
  FirmwareRig after;
  crash_and_restart(after);
  EXPECT_FALSE(after.armed());
  after.run_for(500);
  ASSERT_EQ(after.got<link::HardError>().size(), 1u);
  EXPECT_EQ(after.got<link::HardError>()[0].rearm, 0u);
  EXPECT_FALSE(after.said("Rearmed after a fault in flight"));
}

TEST_F(FirmwareCrash, ABadChecksumMeansNothingHappened) {
  fly_quadrotor();
  for (const std::size_t byte : {0u, 5u, 39u, 40u}) {
    FirmwareRig after;
    crash_and_restart(after, byte);
    EXPECT_FALSE(after.armed()) << byte;
    after.run_for(500);
    EXPECT_TRUE(after.got<link::HardError>().empty()) << byte;
  }
}

TEST_F(FirmwareCrash, AWrongArmWordWithAGoodChecksumDoesNotArm) {
  fly_quadrotor();
  rig_.firmware().record_fault({});
  std::array<std::uint8_t, CrashRecord::kBytes> record{};
  ASSERT_TRUE(rig_.board.backup.read(record.data(), record.size()));
  record[4] = static_cast<std::uint8_t>(record[4] + 1);
  unsigned first = 0, second = 0;  // Fletcher-16 of the first 40 bytes, by hand
  for (std::size_t k = 0; k < 40; ++k) {
    first = (first + record[k]) % 255;
    second = (second + first) % 255;
  }
  record[40] = static_cast<std::uint8_t>(second);
  record[41] = static_cast<std::uint8_t>(first);
  FirmwareRig after;
  ASSERT_TRUE(after.board.backup.write(record.data(), record.size()));
  after.board.storage.set_bytes(rig_.board.storage.bytes());
  after.start();
  EXPECT_FALSE(after.armed());
  after.run_for(500);
  EXPECT_EQ(after.got<link::HardError>().size(), 1u);
}

TEST_F(FirmwareCrash, WithErrorsRearmingFailsAndIsTold) {
  fly_quadrotor();
  FirmwareRig after;
  crash_and_restart(after);
  FirmwareRig blank;  // armed record, but nothing stored: error word 0xA1
  rig_.firmware().record_fault({});
  std::array<std::uint8_t, CrashRecord::kBytes> record{};
  ASSERT_TRUE(rig_.board.backup.read(record.data(), record.size()));
  ASSERT_TRUE(blank.board.backup.write(record.data(), record.size()));
  blank.start();
  EXPECT_FALSE(blank.armed());
  blank.run_for(500);
  EXPECT_TRUE(blank.said("Fault in flight, but rearming failed"));
}

// Weak point 67: nothing helped if the mixer had never been written.
TEST_F(FirmwareCrash, ArmingStoresWhatWasNotWrittenSoThatRearmingWorks) {
  rig_.start();
  rig_.run_for(100);
  rig_.set_param("PRIMARY_MIXER", 2);
  rig_.set_param("FAILSAFE_THR", 0.4f);
  rig_.set_param("ACC_X_BIAS", 1e-6f);
  rig_.arm();
  rig_.rc.channels[FirmwareRig::kThrottle] = 0.8f;
  rig_.run_for(100);
  FirmwareRig after;
  crash_and_restart(after);
  EXPECT_TRUE(after.armed());
}

// Weak point 23: a restart in flight goes on from the attitude before, whatever the accelerometer
// measures between thrust and free fall.
TEST_F(FirmwareCrash, AfterARestartInFlightTheAttitudeIsThatBefore) {
  rig_.accel_m_s2 = {0.0f, -9.80665f * 0.5f, -9.80665f * 0.8660254f};  // rolled by 30 degrees
  fly_quadrotor();
  ASSERT_NEAR(rig_.firmware().estimator().estimate().roll_rad, 0.5236f, 1e-3f);
  FirmwareRig after;
  after.accel_m_s2 = {0.5f, 0.2f, -1.0f};  // its motors stood still
  crash_and_restart(after);
  after.pass();
  after.pass();  // the first sample only sets the time
  EXPECT_NEAR(after.firmware().estimator().estimate().roll_rad, 0.5236f, 1e-3f);
  EXPECT_NEAR(after.firmware().estimator().estimate().pitch_rad, 0.0f, 1e-3f);
}

TEST_F(FirmwareCrash, WithoutItsPartOfTheRecordTheAttitudeStartsFromTheAccelerometer) {
  fly_quadrotor();
  FirmwareRig after;
  after.accel_m_s2 = {0.0f, -9.80665f * 0.5f, -9.80665f * 0.8660254f};
  crash_and_restart(after, CrashRecord::kMotionAt + 5);
  EXPECT_TRUE(after.armed());
  after.pass();
  after.pass();
  EXPECT_NEAR(after.firmware().estimator().estimate().roll_rad, 0.5236f, 1e-3f);

  FirmwareRig cold;
  cold.accel_m_s2 = after.accel_m_s2;
  cold.store_quadrotor();
  cold.start();
  cold.pass();
  cold.pass();
  EXPECT_NEAR(cold.firmware().estimator().estimate().roll_rad, 0.5236f, 1e-3f)
      << "so does a cold boot of a vehicle that is not level";
}

}  // namespace
}  // namespace rosflight::core
