// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/fram.hpp"

#include <random>

#include "firmware/boards/parts/mcp4017.hpp"
#include "firmware/boards/parts/models/fram_model.hpp"
#include "firmware/boards/parts/test/sensor_rig.hpp"
#include "firmware/hal/test/contract/storage_contract.hpp"

namespace rosflight::boards::parts {
namespace {

using hal::milliseconds;

/// A clock that is looked at while waiting: time goes on, and with it the bus.
struct PassingTime final : hal::Clock {
  explicit PassingTime(Rig& r) : rig{r} {}
  Time now() const override {
    rig.run_for(Time{20});
    return rig.now();
  }
  Rig& rig;
};

struct FramBench {
  FramBench() {
    spi.connect(0, model);
    fram.identify();
  }
  Rig rig;
  PassingTime clock{rig};
  Rig::Spi spi{rig, 4e6};
  SharedPort port{spi.bus, 0};
  models::FramModel model;
  Fram fram{port, clock};
};

struct FramTraits {
  hal::Storage& role() { return bench.fram; }
  void power_cycle() {
    bench.model.set_power(false);
    bench.model.set_power(true);
  }
  FramBench bench;
};

class FramTest : public testing::Test, protected FramBench {};

TEST_F(FramTest, IsIdentifiedInBothVersions) {
  EXPECT_STREQ(fram.message(), "FRAM: ok");
  EXPECT_EQ(fram.size(), 32768u);
  model.identity[8] = 0x00;
  EXPECT_TRUE(fram.identify());
}

TEST_F(FramTest, AWrongMuteOrStuckPartIsSaidAndHasNoSize) {
  std::array<std::uint8_t, 4> bytes{};
  model.identity[7] = 0x25;
  EXPECT_FALSE(fram.identify());
  EXPECT_STREQ(fram.message(), "FRAM: identity 0xC2 0x25, expected 0xC2 0x22");
  EXPECT_EQ(fram.size(), 0u);
  EXPECT_FALSE(fram.read(0, bytes.data(), 4));
  EXPECT_FALSE(fram.write(0, bytes.data(), 4));
  EXPECT_FALSE(fram.flush());
  model.mute = true;
  EXPECT_FALSE(fram.identify());
  EXPECT_STREQ(fram.message(), "FRAM: identity 0xFF 0xFF, expected 0xC2 0x22");
  spi.fault = true;
  EXPECT_FALSE(fram.identify());
  EXPECT_STREQ(fram.message(), "FRAM: bus fault");
}

TEST_F(FramTest, WritesOnlyWithPermission) {
  const std::array<std::uint8_t, 130> data{1, 2, 3};
  EXPECT_TRUE(fram.write(100, data.data(), data.size()));
  EXPECT_EQ(model.complaints(), std::vector<std::string>{});
  EXPECT_EQ(model.cells[102], 3);
}

TEST_F(FramTest, AStuckBusEndsInTimeAndBlocksNothingLater) {
  std::array<std::uint8_t, 4> bytes{};
  spi.stuck = true;
  const Time begun = rig.now();
  EXPECT_FALSE(fram.write(0, bytes.data(), 4));
  EXPECT_LE(rig.now() - begun, milliseconds(21));
  spi.stuck = false;
  EXPECT_TRUE(fram.write(0, bytes.data(), 4));
  spi.fault = true;
  EXPECT_FALSE(fram.read(0, bytes.data(), 4));
  spi.fault = false;
  EXPECT_TRUE(fram.read(0, bytes.data(), 4));
}

TEST_F(FramTest, ATransferThatIsStillQueuedIsNotReused) {
  std::array<std::uint8_t, 4> bytes{};
  spi.stuck = true;
  rig.ticking = false;  // nobody aborts
  EXPECT_FALSE(fram.read(0, bytes.data(), 4));
  const Time begun = rig.now();
  EXPECT_FALSE(fram.read(0, bytes.data(), 4));
  EXPECT_EQ(rig.now(), begun);
}

TEST_F(FramTest, ABlockOfParametersTakesLessThanAQuarterOfAMillisecond) {
  std::array<std::uint8_t, 63> block{};
  const Time begun = rig.now();
  EXPECT_TRUE(fram.write(0, block.data(), block.size()));
  EXPECT_LE(rig.now() - begun, Time{250});
}

/// 240 entries of a set of parameters, 21 bytes each: three in each transfer of 64 bytes, which takes
/// (3 + 64) 8 / 4 MHz = 134 us on the wire. One by one there were 240 transfers to begin and to wait for.
TEST_F(FramTest, SmallReadsOneBehindTheOtherShareATransfer) {
  for (std::size_t k = 0; k < model.cells.size(); ++k)
    model.cells[k] = static_cast<std::uint8_t>(k % 251);
  model.transfers = 0;
  std::array<std::uint8_t, 21> entry{};
  for (std::size_t at = 12; at < 12 + 240 * entry.size(); at += entry.size()) {
    ASSERT_TRUE(fram.read(at, entry.data(), entry.size()));
    for (std::size_t k = 0; k < entry.size(); ++k) ASSERT_EQ(entry[k], (at + k) % 251) << at;
  }
  EXPECT_EQ(model.transfers, 80);
}

TEST_F(FramTest, WhatIsReadAgainOrWrittenComesFromThePart) {
  std::array<std::uint8_t, 4> bytes{};
  EXPECT_TRUE(fram.read(8, bytes.data(), 4));
  model.cells[9] = 7;  // a bit that flipped
  EXPECT_TRUE(fram.read(8, bytes.data(), 4));
  EXPECT_EQ(bytes[1], 7);
  const std::array<std::uint8_t, 4> written{1, 2, 3, 4};
  EXPECT_TRUE(fram.write(12, written.data(), 4));
  EXPECT_TRUE(fram.read(12, bytes.data(), 4));
  EXPECT_EQ(bytes, written);
  std::array<std::uint8_t, 40> last{};
  EXPECT_TRUE(fram.read(Fram::kBytes - 40, last.data(), 20));
  EXPECT_TRUE(fram.read(Fram::kBytes - 20, last.data(), 20));
  EXPECT_FALSE(fram.read(Fram::kBytes, last.data(), 1));
}

/// Properties over random reads and writes: what is read is what the part holds.
TEST_F(FramTest, RandomReadsAndWritesAgreeWithThePart) {
  std::mt19937 random{1};
  std::size_t next = 0;  // where the read before ended
  std::array<std::uint8_t, 200> data{};
  for (int k = 0; k < 2000; ++k) {
    const std::size_t at = random() % 400;
    const std::size_t n = 1 + random() % data.size();
    if (random() % 4 == 0) {
      for (auto& byte : data) byte = static_cast<std::uint8_t>(random());
      ASSERT_TRUE(fram.write(at, data.data(), n));
    } else {
      const std::size_t begin = random() % 2 == 0 ? at : next;
      ASSERT_TRUE(fram.read(begin, data.data(), n));
      next = (begin + n) % 400;
      ASSERT_TRUE(std::equal(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(n),
                             model.cells.begin() + static_cast<std::ptrdiff_t>(begin)));
    }
  }
}

// ---- MCP4017

class Mcp4017Test : public SensorTest<hal::MagSample> {
 protected:
  Mcp4017Test() {
    i2c_.connect(model_);
    rig_.add(driver_);
  }
  Driver& driver() override { return driver_; }
  hal::Source<hal::MagSample>& source() override { std::abort(); }

  Rig::I2c i2c_{rig_, 100e3};
  SharedPort port_{i2c_.bus, Mcp4017::kAddress};
  models::Mcp4017Model model_;
  Mcp4017 driver_{port_, 4.8f};
};

TEST_F(Mcp4017Test, TheWiperFollowsTheFit) {
  EXPECT_EQ(Mcp4017::wiper(4.8f), 92);  // 92.355 by hand
  EXPECT_EQ(Mcp4017::wiper(8.2f), 0);   // -0.09
  EXPECT_EQ(Mcp4017::wiper(6.0f), 46);  // ((-4.956 + 21.035) 6 - 193.555) 6 + 628.130 = 45.63
  EXPECT_EQ(Mcp4017::wiper(0.0f), 92);
  EXPECT_EQ(Mcp4017::wiper(99.0f), 0);
}

TEST_F(Mcp4017Test, IsWrittenAndReadBack) {
  run();
  EXPECT_EQ(model_.wiper, 92);
  EXPECT_STREQ(driver_.message(), "MCP4017: ok");
}

TEST_F(Mcp4017Test, ALostWiperIsWrittenAgainWithinTwoSeconds) {
  run();
  model_.set_power(false);
  model_.set_power(true);
  EXPECT_EQ(model_.wiper, 0x3F);
  rig_.run_for(milliseconds(2500));
  EXPECT_EQ(model_.wiper, 92);
}

TEST_F(Mcp4017Test, AMuteOrStuckWiperIsSaid) {
  model_.stuck = true;
  start();
  rig_.run_for(milliseconds(10));
  EXPECT_STREQ(driver_.message(), "MCP4017: wiper is 63, written 92");
  model_.stuck = false;
  model_.mute = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "MCP4017: no answer");
  i2c_.fault = true;
  rig_.run_for(milliseconds(1500));
  EXPECT_STREQ(driver_.message(), "MCP4017: bus fault");
}

TEST_F(Mcp4017Test, AWarmStartLeavesARightWiperAlone) {
  run();
  const int writes = model_.writes;
  start(Start::kWarm);
  time_to_run();
  EXPECT_EQ(model_.writes, writes);
}

}  // namespace
}  // namespace rosflight::boards::parts

namespace rosflight::hal::contract {
INSTANTIATE_TYPED_TEST_SUITE_P(Fram, StorageContract, boards::parts::FramTraits);
}
