// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/crash_record.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "firmware/boards/simulated/simulated_board.hpp"

namespace rosflight::core {
namespace {

CrashRecord example() {
  CrashRecord r;
  r.above_idle = true;
  r.fault_count = 0x0102;
  r.error_word = 0x00A1;
  r.armed = true;
  r.motion = {
      Motion::kUnknown, {0.5f, -0.5f, 0.5f, 0.5f}, {1.0f, -2.0f, 3.0f}, {0.25f, 0.0f, -0.125f}};
  r.motion_age = hal::microseconds(0x00012345);
  r.registers = {0x10111213, 0x20212223, 0x30313233, 0x40414243,
                 0x50515253, 0x60616263, 0x08001234, 0x81000003};
  return r;
}

std::vector<std::uint8_t> memory_of(hal::BackupMemory& memory) {
  std::vector<std::uint8_t> bytes(CrashRecord::kBytes);
  EXPECT_TRUE(memory.read(bytes.data(), bytes.size()));
  return bytes;
}

/// Two sums modulo 255 as in the record's definition, written without the code under test.
std::uint32_t two_sums(const std::vector<std::uint8_t>& bytes) {
  unsigned first = 0;
  unsigned second = 0;
  for (std::size_t k = 0; k < 40; ++k) {
    first += bytes[k];
    second += first;
  }
  return first % 255 * 256 + second % 255;
}

TEST(CrashRecord, LaysOutItsFieldsLittleEndian) {
  boards::SimulatedBackup memory;
  ASSERT_TRUE(write_crash_record(memory, example()));
  const auto b = memory_of(memory);
  const std::vector<std::uint8_t> head{0x02, 0x01, 0xA1, 0x00, 0x11, 0xFA, 0xD2, 0xBA};
  EXPECT_EQ(std::vector<std::uint8_t>(b.begin(), b.begin() + 8), head);
  EXPECT_EQ(std::vector<std::uint8_t>(b.begin() + 8, b.begin() + 12),
            (std::vector<std::uint8_t>{0x13, 0x12, 0x11, 0x10}));
  EXPECT_EQ(std::vector<std::uint8_t>(b.begin() + 32, b.begin() + 36),
            (std::vector<std::uint8_t>{0x34, 0x12, 0x00, 0x08}));  // pc
  const std::uint32_t sum = two_sums(b);
  EXPECT_EQ(b[40] + 256u * b[41], sum);
  EXPECT_EQ(b[42], 0u);
  EXPECT_EQ(b[43], 0u);
  EXPECT_EQ(CrashRecord::kReferenceBytes, 44u);
}

TEST(CrashRecord, OurOwnPartFollowsThatOfTheReference) {
  boards::SimulatedBackup memory;
  CrashRecord written = example();
  written.above_idle = true;
  written.rearm_age_ms = {0x01020304, 5, CrashRecord::kNever};
  ASSERT_TRUE(write_crash_record(memory, written));
  const auto b = memory_of(memory);
  EXPECT_EQ(std::vector<std::uint8_t>(b.begin() + 44, b.begin() + 52),
            (std::vector<std::uint8_t>{0x5D, 0x7E, 0x11, 0x0F, 0x04, 0x03, 0x02, 0x01}));
  CrashRecord read;
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_TRUE(read.above_idle);
  EXPECT_EQ(read.rearm_age_ms, written.rearm_age_ms);
}

TEST(CrashRecord, TheMotionFollowsAndIsReadBackBitByBit) {
  boards::SimulatedBackup memory;
  ASSERT_TRUE(write_crash_record(memory, example()));
  const auto b = memory_of(memory);
  EXPECT_EQ(std::vector<std::uint8_t>(b.begin() + 64, b.begin() + 72),
            (std::vector<std::uint8_t>{0x45, 0x23, 0x01, 0x00, 0x00, 0x00, 0x00, 0x3F}));
  CrashRecord read;
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_EQ(read.motion_age, hal::microseconds(0x00012345));
  EXPECT_EQ(read.motion.q_WB.x, -0.5f);
  EXPECT_EQ(read.motion.q_WB.z, 0.5f);
  EXPECT_EQ(read.motion.rates_rad_s, Vector3(1.0f, -2.0f, 3.0f));
  EXPECT_EQ(read.motion.bias_rad_s, Vector3(0.25f, 0.0f, -0.125f));
  CrashRecord old = example();
  old.motion_age = Time::max();
  ASSERT_TRUE(write_crash_record(memory, old));
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_GT(read.motion_age, hal::milliseconds(3'600'000)) << "4295 s is the oldest";
}

TEST(CrashRecord, ARecordOfTheReferenceAloneCountsAsWrittenOnTheGround) {
  boards::SimulatedBackup memory;
  CrashRecord written = example();
  written.above_idle = true;
  ASSERT_TRUE(write_crash_record(memory, written));
  auto b = memory_of(memory);
  std::fill(b.begin() + CrashRecord::kReferenceBytes, b.end(), std::uint8_t{0xFF});
  ASSERT_TRUE(memory.write(b.data(), b.size()));
  CrashRecord read;
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_TRUE(read.armed);
  EXPECT_FALSE(read.above_idle);
  EXPECT_FALSE(read.may_rearm());
}

TEST(CrashRecord, RearmsThreeTimesInAMinuteAtMostAndOnlyInTheAir) {
  constexpr std::uint32_t kNever = CrashRecord::kNever;
  CrashRecord r;
  r.armed = r.above_idle = true;
  EXPECT_TRUE(r.may_rearm()) << "the first fault";
  r.rearm_age_ms = {100, kNever, kNever};
  EXPECT_TRUE(r.may_rearm());
  r.rearm_age_ms = {100, 300, kNever};
  EXPECT_TRUE(r.may_rearm()) << "two rearmings within 60 s, the third is allowed";
  r.rearm_age_ms = {100, 300, 600};
  EXPECT_FALSE(r.may_rearm()) << "it would be the fourth";
  r.rearm_age_ms = {20'000, 40'000, 59'999};
  EXPECT_FALSE(r.may_rearm());
  r.rearm_age_ms = {20'000, 40'000, 60'000};
  EXPECT_TRUE(r.may_rearm()) << "the oldest of the three is 60 s ago";
  r.above_idle = false;
  EXPECT_FALSE(r.may_rearm());
  r.above_idle = true;
  r.armed = false;
  EXPECT_FALSE(r.may_rearm());
}

TEST(CrashRecord, IsReadBackOnce) {
  boards::SimulatedBackup memory;
  const CrashRecord written = example();
  ASSERT_TRUE(write_crash_record(memory, written));
  CrashRecord read;
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_EQ(read.fault_count, written.fault_count);
  EXPECT_EQ(read.error_word, written.error_word);
  EXPECT_TRUE(read.armed);
  EXPECT_EQ(read.registers, written.registers);
  EXPECT_EQ(read.pc(), 0x08001234u);
  EXPECT_EQ(memory_of(memory), std::vector<std::uint8_t>(CrashRecord::kBytes, 0));
  EXPECT_FALSE(take_crash_record(memory, read));
}

TEST(CrashRecord, BlankMemoryHoldsNone) {
  boards::SimulatedBackup memory;
  CrashRecord read;
  read.fault_count = 77;
  EXPECT_FALSE(take_crash_record(memory, read));
  EXPECT_EQ(read.fault_count, 77);
}

TEST(CrashRecord, AnyFlippedBitIsNoticedAndTheMemoryCleared) {
  const CrashRecord written = example();
  for (std::size_t byte = 0; byte < CrashRecord::kBytes; ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      boards::SimulatedBackup memory;
      ASSERT_TRUE(write_crash_record(memory, written));
      auto b = memory_of(memory);
      b[byte] = static_cast<std::uint8_t>(b[byte] ^ (1u << bit));
      ASSERT_TRUE(memory.write(b.data(), b.size()));
      CrashRecord read;
      if (byte < CrashRecord::kReferenceBytes) {
        ASSERT_FALSE(take_crash_record(memory, read)) << byte << "." << bit;
      } else {
        ASSERT_TRUE(take_crash_record(memory, read)) << byte << "." << bit;
        const bool in_motion = byte >= CrashRecord::kMotionAt;
        ASSERT_EQ(read.above_idle, in_motion) << byte << "." << bit;
        ASSERT_EQ(read.motion_age == -Motion::kUnknown, in_motion) << byte << "." << bit;
      }
      ASSERT_EQ(memory_of(memory), std::vector<std::uint8_t>(CrashRecord::kBytes, 0));
    }
  }
}

TEST(CrashRecord, OnlyTheArmWordMeansArmed) {
  boards::SimulatedBackup memory;
  CrashRecord record = example();
  record.armed = false;
  ASSERT_TRUE(write_crash_record(memory, record));
  EXPECT_EQ(memory_of(memory)[4], 0u);
  CrashRecord read;
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_FALSE(read.armed);

  // A wrong arm word under a right checksum: valid record, not armed.
  ASSERT_TRUE(write_crash_record(memory, example()));
  auto b = memory_of(memory);
  b[4] ^= 0xFFu;
  const std::uint32_t sum = two_sums(b);
  b[40] = static_cast<std::uint8_t>(sum);
  b[41] = static_cast<std::uint8_t>(sum >> 8);
  ASSERT_TRUE(memory.write(b.data(), b.size()));
  ASSERT_TRUE(take_crash_record(memory, read));
  EXPECT_FALSE(read.armed);
  EXPECT_EQ(read.fault_count, 0x0102);
}

/// Backup memory that is not there, as on boards without it.
class NoMemory final : public hal::BackupMemory {
 public:
  bool read(std::uint8_t* /*data*/, std::size_t /*count*/) override { return false; }
  bool write(const std::uint8_t* /*data*/, std::size_t /*count*/) override { return false; }
  void clear() override { ++clears; }
  int clears{0};
};

TEST(CrashRecord, ABoardWithoutBackupMemoryHasNone) {
  NoMemory memory;
  CrashRecord record;
  EXPECT_FALSE(write_crash_record(memory, example()));
  EXPECT_FALSE(take_crash_record(memory, record));
  EXPECT_EQ(memory.clears, 0);
}

TEST(CrashRecord, FitsIntoBackupMemory) {
  static_assert(CrashRecord::kBytes <= hal::BackupMemory::kSize);
}

}  // namespace
}  // namespace rosflight::core
