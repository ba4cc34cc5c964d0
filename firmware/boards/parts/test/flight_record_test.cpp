// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/flight_record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;
using Kind = FlightRecord::Kind;

/// 100 of them in a second.
hal::Time at(std::int64_t k) {
  return milliseconds(10 * k);
}

FlightMoment moment(int k) {
  FlightMoment m;
  m.time = at(k);
  const auto f = static_cast<float>(k);
  m.accel_m_s2 = {f, 0.5f, -9.80665f};
  m.gyro_rad_s = {-0.25f * f, 1.0f, 2.0f};
  m.q_WB = {1.0f, 0.1f, 0.2f, 0.3f};
  m.command = {0, 1, 2, 3, 4, 5, 6, 7, 8, f};
  for (std::size_t i = 0; i < m.outputs.size(); ++i) m.outputs[i] = static_cast<float>(i) / 14.0f;
  m.error_word = 0xA1;
  m.flags = 3;
  return m;
}

class FlightRecordTest : public testing::Test {
 protected:
  static constexpr std::size_t kSlots = 50;
  FlightRecordTest() {
    std::mt19937 random(1);
    for (auto& byte : memory_) byte = static_cast<std::uint8_t>(random());  // as after power-up
    record_.attach(true, milliseconds(0));
  }
  FlightRecord again() { return FlightRecord{memory_.data(), memory_.size()}; }

  std::vector<std::uint8_t> memory_ =
      std::vector<std::uint8_t>(kSlots * FlightRecord::kSlotBytes + 17);
  FlightRecord record_{memory_.data(), memory_.size()};
  FlightRecord::Entry entry_;
};

TEST_F(FlightRecordTest, KeepsWhatIsEntered) {
  record_.add(moment(7));
  record_.add(milliseconds(80), "Armed", 6);
  ASSERT_EQ(record_.size(), 3u);
  ASSERT_TRUE(record_.read(0, entry_));
  EXPECT_EQ(entry_.kind, Kind::kStart);
  ASSERT_TRUE(record_.read(1, entry_));
  EXPECT_EQ(entry_.kind, Kind::kMoment);
  EXPECT_EQ(entry_.moment.time, milliseconds(70));
  EXPECT_EQ(entry_.moment.accel_m_s2, moment(7).accel_m_s2);
  EXPECT_EQ(entry_.moment.gyro_rad_s, moment(7).gyro_rad_s);
  EXPECT_EQ(entry_.moment.q_WB, moment(7).q_WB);
  EXPECT_EQ(entry_.moment.command, moment(7).command);
  for (std::size_t k = 0; k < hal::kOutputs; ++k) {
    EXPECT_NEAR(entry_.moment.outputs[k], moment(7).outputs[k], 1.0f / 65535.0f);
  }
  EXPECT_EQ(entry_.moment.error_word, 0xA1);
  EXPECT_EQ(entry_.moment.flags, 3);
  ASSERT_TRUE(record_.read(2, entry_));
  EXPECT_EQ(entry_.kind, Kind::kText);
  EXPECT_EQ(entry_.moment.time, milliseconds(80));
  EXPECT_STREQ(entry_.text.data(), "Armed");
  EXPECT_EQ(entry_.severity, 6);
  EXPECT_FALSE(record_.read(3, entry_));
}

TEST_F(FlightRecordTest, ForgetsTheOldestAndNothingElse) {
  for (int k = 1; k <= 500; ++k) record_.add(moment(k));
  ASSERT_EQ(record_.size(), kSlots);
  EXPECT_EQ(record_.capacity(), kSlots);
  for (std::size_t k = 0; k < kSlots; ++k) {
    ASSERT_TRUE(record_.read(k, entry_));
    EXPECT_EQ(entry_.moment.time, at(static_cast<std::int64_t>(500 - kSlots + 1 + k)));
  }
}

TEST_F(FlightRecordTest, TwentySecondsFitTheSizeOfTheComment) {
  std::vector<std::uint8_t> memory(2100 * FlightRecord::kSlotBytes);
  FlightRecord record{memory.data(), memory.size()};
  record.attach(true, milliseconds(0));
  for (int k = 0; k < 3000; ++k) {
    record.add(moment(k));
    if (k % 20 == 0) record.add(at(k), "text");
  }
  ASSERT_TRUE(record.read(0, entry_));
  EXPECT_LE(entry_.moment.time, at(2999 - 1999));
}

TEST_F(FlightRecordTest, SurvivesAWarmStart) {
  for (int k = 1; k <= 70; ++k) record_.add(moment(k));
  FlightRecord after = again();
  EXPECT_EQ(after.attach(false, milliseconds(3)), kSlots);
  ASSERT_EQ(after.size(), kSlots);  // a start took the place of the oldest
  ASSERT_TRUE(after.read(kSlots - 1, entry_));
  EXPECT_EQ(entry_.kind, Kind::kStart);
  EXPECT_EQ(entry_.moment.time, milliseconds(3));
  ASSERT_TRUE(after.read(kSlots - 2, entry_));
  EXPECT_EQ(entry_.moment.time, milliseconds(700));
  after.add(moment(900));
  ASSERT_TRUE(after.read(kSlots - 1, entry_));
  EXPECT_EQ(entry_.moment.time, milliseconds(9000));
}

TEST_F(FlightRecordTest, ASlotThatWasBeingWrittenIsLostAndNoOther) {
  for (int k = 1; k <= 120; ++k) record_.add(moment(k));
  // Entry 121 was the start's; cut the newest in its middle.
  const std::size_t newest = (121 - 1) % kSlots;
  for (std::size_t k = 60; k < 128; ++k) memory_[newest * 128 + k] = 0x55;
  FlightRecord after = again();
  EXPECT_EQ(after.attach(false, {}), kSlots - 1);
  std::size_t good = 0;
  for (std::size_t k = 0; k < after.size(); ++k) good += after.read(k, entry_) ? 1u : 0u;
  EXPECT_EQ(good, kSlots);  // the start has been entered in place of the one that was cut
}

TEST_F(FlightRecordTest, DamageInTheMiddleCostsWhatIsDamaged) {
  for (int k = 1; k <= 60; ++k) record_.add(moment(k));
  memory_[20 * 128 + 40] = static_cast<std::uint8_t>(memory_[20 * 128 + 40] ^ 4);
  std::size_t good = 0;
  for (std::size_t k = 0; k < record_.size(); ++k) good += record_.read(k, entry_) ? 1u : 0u;
  EXPECT_EQ(good, kSlots - 1);
}

TEST_F(FlightRecordTest, TheBytesOfAnEntryAreReadAnywhere) {
  for (int k = 1; k <= 60; ++k) record_.add(moment(k));
  EXPECT_EQ(record_.oldest(), 12u);
  EXPECT_EQ(record_.newest(), 61u);
  std::array<std::uint8_t, FlightRecord::kSlotBytes> bytes{};
  std::copy_n(record_.bytes(30), bytes.size(), bytes.begin());
  ASSERT_TRUE(FlightRecord::decode(bytes.data(), entry_));
  EXPECT_EQ(entry_.number, 30u);
  EXPECT_EQ(entry_.moment.time, at(29));
  bytes[127] ^= 1u;
  EXPECT_FALSE(FlightRecord::decode(bytes.data(), entry_));
  bytes.fill(0);
  EXPECT_FALSE(FlightRecord::decode(bytes.data(), entry_)) << "the CRC of zeros is not 0";
}

TEST_F(FlightRecordTest, RandomMemoryIsAnEmptyRecord) {
  std::mt19937 random(9);
  for (auto& byte : memory_) byte = static_cast<std::uint8_t>(random());
  FlightRecord after = again();
  EXPECT_EQ(after.attach(false, {}), 0u);
  EXPECT_EQ(after.size(), 1u);
}

TEST_F(FlightRecordTest, APowerCycleClearsIt) {
  record_.add(moment(1));
  FlightRecord after = again();
  EXPECT_EQ(after.attach(true, {}), 0u);
  EXPECT_EQ(after.size(), 1u);
}

TEST_F(FlightRecordTest, HeldItKeepsWhatThereIs) {
  record_.add(moment(1));
  record_.hold(true);
  record_.add(moment(2));
  record_.add({}, "text");
  EXPECT_EQ(record_.size(), 2u);
  record_.hold(false);
  record_.add(moment(3));
  EXPECT_EQ(record_.size(), 3u);
}

TEST_F(FlightRecordTest, LongTextsAreCutAndOddOutputsLimited) {
  record_.add({}, std::string(300, 'x').c_str());
  ASSERT_TRUE(record_.read(1, entry_));
  EXPECT_EQ(std::string(entry_.text.data()), std::string(FlightRecord::kTextBytes, 'x'));
  FlightMoment odd;
  odd.outputs = {-1.0f, 2.0f, std::numeric_limits<float>::quiet_NaN()};
  record_.add(odd);
  ASSERT_TRUE(record_.read(2, entry_));
  EXPECT_EQ(entry_.moment.outputs[0], 0.0f);
  EXPECT_EQ(entry_.moment.outputs[1], 1.0f);
  EXPECT_EQ(entry_.moment.outputs[2], 0.0f);
}

TEST_F(FlightRecordTest, NoMemoryIsNoRecord) {
  FlightRecord none{nullptr, 0};
  EXPECT_EQ(none.attach(true, {}), 0u);
  none.add(moment(1));
  EXPECT_EQ(none.size(), 0u);
}

}  // namespace
}  // namespace rosflight::boards::parts
