// SPDX-License-Identifier: BSD-3-Clause
#include "ground/blackbox.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace rosflight::ground {
namespace {

using boards::parts::FlightMoment;
using boards::parts::FlightRecord;
using Kind = FlightRecord::Kind;

FlightMoment moment(int time_ms) {
  FlightMoment m;
  m.time = hal::milliseconds(time_ms);
  m.accel_m_s2 = {0.5F, -0.25F, -9.75F};
  m.gyro_rad_s = {0.125F, 0.0F, static_cast<float>(time_ms)};
  m.q_WB = {1.0F, 0.0F, 0.0F, 0.0F};
  m.command[9] = 7.0F;
  m.outputs[13] = 1.0F;
  m.error_word = 4;
  m.flags = 3;
  return m;
}

/// A board that flew, crashed at 30.02 s of its clock, and flew on.
class Blackbox : public ::testing::Test {
 protected:
  Blackbox() {
    record_.attach(true, hal::milliseconds(200));
    record_.add(moment(30'000));
    record_.add(hal::milliseconds(30'005), "Battery low, 10.2 V", 4);
    record_.add(moment(30'010));
    FlightRecord after{memory_.data(), memory_.size()};
    after.attach(false, hal::milliseconds(3));
    after.add(moment(23));
    for (std::uint32_t number = after.oldest(); number <= after.newest(); ++number)
      std::copy_n(after.bytes(number), entries_[number].size(), entries_[number].begin());
  }

  std::vector<std::uint8_t> memory_ = std::vector<std::uint8_t>(20 * FlightRecord::kSlotBytes);
  FlightRecord record_{memory_.data(), memory_.size()};
  std::map<std::uint32_t, companion::RecordReader::Bytes> entries_;
};

TEST_F(Blackbox, TimeGoesOnOverARestart) {
  const auto record = decode_record(entries_);
  ASSERT_EQ(record.size(), 6U);
  EXPECT_EQ(record[0].entry.kind, Kind::kStart);
  EXPECT_DOUBLE_EQ(record[1].time_s, 29.8);
  EXPECT_DOUBLE_EQ(record[3].time_s, 29.81);
  EXPECT_EQ(record[4].entry.kind, Kind::kStart);
  EXPECT_DOUBLE_EQ(record[4].time_s, 29.81);
  EXPECT_DOUBLE_EQ(record[5].time_s, 29.83);
}

TEST_F(Blackbox, DamagedEntriesAreLeftOut) {
  entries_.at(2)[50] ^= 1U;
  const auto record = decode_record(entries_);
  ASSERT_EQ(record.size(), 5U);
  EXPECT_EQ(record[1].entry.kind, Kind::kText);
}

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST_F(Blackbox, TheFolderHasALogAndTables) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("blackbox_" + std::to_string(::getpid()));
  write_record(decode_record(entries_), folder);
  EXPECT_EQ(content(folder / "texts.csv"),
            "time_s,board_time_us,severity,text\n"
            "0.000000,200000,0,\"(start of the board)\"\n"
            "29.805000,30005000,4,\"Battery low, 10.2 V\"\n"
            "29.810000,3000,0,\"(start of the board)\"\n");
  const std::string table = content(folder / "record.csv");
  std::istringstream rows(table);
  std::string header, row;
  std::getline(rows, header);
  std::getline(rows, row);
  EXPECT_EQ(row,
            "29.800000,30000000,1,1,0,4,0.5,-0.25,-9.75,0.125,0,30000,1,0,0,0,"
            "0,0,0,0,0,0,0,0,0,7,0,0,0,0,0,0,0,0,0,0,0,0,0,1");
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  EXPECT_GT(std::filesystem::file_size(folder / "flight.mcap"), 1000U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rosflight::ground
