// SPDX-License-Identifier: BSD-3-Clause
// Bank 2 of the flash, as the firmware's FlashSectors uses it and as it must not.
#include "firmware/boards/stm32h7/emulator/flash_control.hpp"

#include <gtest/gtest.h>

#include "firmware/boards/stm32h7/emulator/test/fake_core.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr std::uint32_t kProgram = flash::CR2_PSIZE(3) | flash::CR2_PG(1);

class FlashControlTest : public ::testing::Test {
 protected:
  FlashControlTest() {
    control.reset();
    core.uncached_from = 0;  // the firmware's MPU says so
  }

  void unlock() {
    control.bus_write(flash::KEYR2, 0x4567'0123U, 4);
    control.bus_write(flash::KEYR2, 0xCDEF'89ABU, 4);
  }
  void write_word(std::uint32_t offset, std::uint32_t first) {
    for (std::uint32_t k = 0; k < 8; ++k) window.bus_write(offset + 4 * k, first + k, 4);
  }
  bool busy() { return flash::SR2_QW.of(control.bus_read(flash::SR2, 4)) != 0; }
  void wait() {
    for (int k = 0; k < 10'000 && busy(); ++k) core.run_for(kTicksPerMicrosecond * 1000);
    control.bus_write(flash::CR2, flash::CR2_PSIZE(3), 4);
  }
  void expect_complaint(const std::string& part) {
    const std::string said = core.only_complaint();
    EXPECT_NE(said.find(part), std::string::npos) << "said: " << said;
  }

  FakeCore core;
  FlashControl control{core};
  FlashSectorsWindow window{core, control};
};

TEST_F(FlashControlTest, AWordIsProgrammedAndASectorErased) {
  unlock();
  control.bus_write(flash::CR2, kProgram, 4);
  write_word(64, 100);
  EXPECT_TRUE(busy());
  wait();
  EXPECT_EQ(window.bus_read(68, 4), 101U);
  EXPECT_EQ(window.bus_read(96, 4), 0xFFFF'FFFFU);
  const std::uint32_t erase = flash::CR2_PSIZE(3) | flash::CR2_SER(1) | flash::CR2_SNB(6);
  control.bus_write(flash::CR2, erase, 4);
  control.bus_write(flash::CR2, erase | flash::CR2_START(1), 4);
  core.run_for(kTicksPerSecond);
  EXPECT_TRUE(busy()) << "1 to 2 s";
  wait();
  EXPECT_EQ(window.bus_read(68, 4), 0xFFFF'FFFFU);
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(FlashControlTest, WhatIsStoredSurvivesAReset) {
  unlock();
  control.bus_write(flash::CR2, kProgram, 4);
  write_word(0, 7);
  wait();
  control.reset();
  EXPECT_EQ(window.bus_read(0, 4), 7U);
}

TEST_F(FlashControlTest, AResetAmidAWordTearsThatWordAlone) {
  unlock();
  control.bus_write(flash::CR2, kProgram, 4);
  write_word(0, 7);
  wait();
  control.bus_write(flash::CR2, kProgram, 4);
  write_word(32, 8);
  EXPECT_TRUE(busy());
  control.reset();
  EXPECT_EQ(control.sectors.torn, 1U);
  EXPECT_EQ(window.bus_read(0, 4), 7U);
  EXPECT_EQ(core.bus_errors, 0);
  window.bus_read(32, 4);
  EXPECT_EQ(core.bus_errors, 1);
  EXPECT_NE(flash::SR2_DBECCERR.of(control.bus_read(flash::SR2, 4)), 0U);
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
}

TEST_F(FlashControlTest, AResetAmidAnEraseLeavesTheEndOfTheSector) {
  constexpr std::uint32_t kLastWord = FlashControl::kSectorBytes - 32;
  unlock();
  for (const std::uint32_t offset : {std::uint32_t{0}, kLastWord}) {
    control.bus_write(flash::CR2, kProgram, 4);
    write_word(offset, 7);
    wait();
  }
  const std::uint32_t erase = flash::CR2_PSIZE(3) | flash::CR2_SER(1) | flash::CR2_SNB(6);
  control.bus_write(flash::CR2, erase, 4);
  control.bus_write(flash::CR2, erase | flash::CR2_START(1), 4);
  core.run_for(kTicksPerSecond / 2);  // a third of it
  EXPECT_TRUE(busy());
  control.reset();
  EXPECT_FALSE(busy());
  EXPECT_EQ(window.bus_read(0, 4), 0xFFFF'FFFFU);
  EXPECT_EQ(window.bus_read(kLastWord, 4), 7U);
  EXPECT_EQ(core.bus_errors, 0);
  window.bus_read(FlashControl::kSectorBytes / 2, 4);
  EXPECT_EQ(core.bus_errors, 1) << "where the erase was";
}

TEST_F(FlashControlTest, AWordThatCannotBeCorrectedIsAnErrorOfTheBusAndAFlag) {
  control.sectors.damage(1, 3);
  window.bus_read(FlashControl::kSectorBytes + 2 * 32, 4);
  EXPECT_EQ(core.bus_errors, 0);
  window.bus_read(FlashControl::kSectorBytes + 3 * 32 + 8, 4);
  EXPECT_EQ(core.bus_errors, 1);
  EXPECT_NE(flash::SR2_DBECCERR.of(control.bus_read(flash::SR2, 4)), 0U);
  control.bus_write(flash::CCR2, flash::SR2_DBECCERR(1), 4);
  EXPECT_EQ(flash::SR2_DBECCERR.of(control.bus_read(flash::SR2, 4)), 0U);
}

TEST_F(FlashControlTest, WhatSiliconWouldNotDoIsComplainedOf) {
  control.bus_write(flash::CR2, kProgram, 4);
  expect_complaint("written while locked");
  unlock();
  write_word(0, 1);
  EXPECT_EQ(core.complaints.size(), 8U);
  EXPECT_NE(core.complaints.front().find("without PG"), std::string::npos);
  core.complaints.clear();
  control.bus_write(flash::CR2, kProgram, 4);
  window.bus_write(0, 1, 4);
  window.bus_write(8, 2, 4);
  expect_complaint("not written whole and in order");
  write_word(32, 1);
  control.bus_write(flash::CR2, kProgram, 4);
  expect_complaint("while the bank is busy");
  window.bus_read(0, 4);
  expect_complaint("read while busy");
  wait();
  control.bus_write(flash::CR2, kProgram, 4);
  write_word(32, 2);
  expect_complaint("programmed twice");
  wait();
  control.bus_write(flash::CR2, flash::CR2_SER(1) | flash::CR2_SNB(6) | flash::CR2_START(1), 4);
  expect_complaint("START before the sector is chosen");
  control.bus_write(flash::CR2, flash::CR2_SER(1) | flash::CR2_SNB(0), 4);
  control.bus_write(flash::CR2, flash::CR2_SER(1) | flash::CR2_SNB(0) | flash::CR2_START(1), 4);
  expect_complaint("not for parameters");
  core.uncached_from = FakeCore::kMemory;
  window.bus_read(0, 4);
  expect_complaint("may lie in the data cache");
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
