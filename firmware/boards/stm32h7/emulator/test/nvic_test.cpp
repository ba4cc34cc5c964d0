// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/nvic.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/boards/stm32h7/emulator/system_control.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

constexpr Nvic::Masks kNone{};

TEST(Nvic, LowerNumberPreemptsAndEqualsDoNot) {
  Nvic nvic;
  for (const unsigned irq : {3U, 4U, 5U}) nvic.enable(irq, true);
  nvic.set_priority(kFirstIrq + 3, 0x50);
  nvic.set_priority(kFirstIrq + 4, 0x50);
  nvic.set_priority(kFirstIrq + 5, 0x10);
  nvic.set_line(4, true);
  ASSERT_EQ(nvic.next(kNone), kFirstIrq + 4);
  nvic.activate(kFirstIrq + 4);
  nvic.set_line(3, true);
  EXPECT_EQ(nvic.next(kNone), 0) << "of equal priority: it waits";
  nvic.set_line(5, true);
  EXPECT_EQ(nvic.next(kNone), kFirstIrq + 5);
  nvic.activate(kFirstIrq + 5);
  EXPECT_TRUE(nvic.nested());
  nvic.set_line(5, false);
  EXPECT_EQ(nvic.deactivate(), kFirstIrq + 5);
  nvic.set_line(4, false);
  nvic.deactivate();
  EXPECT_EQ(nvic.next(kNone), kFirstIrq + 3);
}

TEST(Nvic, LevelThatStaysHighComesAgain) {
  Nvic nvic;
  nvic.enable(7, true);
  nvic.set_line(7, true);
  nvic.activate(nvic.next(kNone));
  EXPECT_FALSE(nvic.any_pending());
  nvic.deactivate();
  EXPECT_EQ(nvic.next(kNone), kFirstIrq + 7);
}

TEST(Nvic, MasksHoldBackWhatTheySay) {
  Nvic nvic;
  nvic.enable(1, true);
  nvic.set_priority(kFirstIrq + 1, 0x50);
  nvic.set_line(1, true);
  EXPECT_EQ(nvic.next({false, false, 0x50}), 0);
  EXPECT_EQ(nvic.next({false, false, 0x60}), kFirstIrq + 1);
  EXPECT_EQ(nvic.next({true, false, 0}), 0);
  EXPECT_TRUE(nvic.any_pending()) << "a masked interrupt wakes from WFI all the same";
  nvic.pend(kHardFault);
  EXPECT_EQ(nvic.next({true, false, 0}), kHardFault);
  EXPECT_EQ(nvic.next({true, true, 0}), 0);
}

/// The MPU as far as the data cache is concerned.
class CacheAttributes : public ::testing::Test {
 protected:
  CacheAttributes() { control.reset(0x0800'0000U); }
  void region(std::uint32_t number, std::uint32_t base, std::uint32_t attributes) {
    write(0xD98, number);
    write(0xD9C, base);
    write(0xDA0, attributes);
  }
  void write(std::uint32_t offset, std::uint32_t value) {
    control.write(0xE000U + offset, value, 4, 0);
  }
  Nvic nvic;
  std::vector<std::string> complaints;
  SystemControl control{nvic, [this](const std::string& what) { complaints.push_back(what); }};
  static constexpr std::uint32_t kSram3 = 0x3004'0000U;
};

TEST_F(CacheAttributes, NothingIsCachedUntilTheCacheIsOn) {
  EXPECT_FALSE(control.cacheable(kSram3));
  write(0xD14, 1U << 16U);
  EXPECT_TRUE(control.cacheable(kSram3));
  EXPECT_FALSE(control.cacheable(0x2000'0000U)) << "tightly coupled memory never is";
  EXPECT_FALSE(control.cacheable(0x4000'0000U));
}

TEST_F(CacheAttributes, ShareableRegionIsNotCached) {
  write(0xD14, 1U << 16U);
  write(0xD94, 5);
  constexpr std::uint32_t kSize32K = 14U << 1U, kEnable = 1U, kC = 1U << 17U, kS = 1U << 18U;
  region(0, kSram3, kSize32K | kC | kEnable);
  EXPECT_TRUE(control.cacheable(kSram3));
  region(0, kSram3, kSize32K | kC | kS | kEnable);
  EXPECT_FALSE(control.cacheable(kSram3));
  EXPECT_FALSE(control.cacheable(kSram3 + 0x7FFF));
  EXPECT_TRUE(control.cacheable(kSram3 + 0x8000));
  EXPECT_TRUE(complaints.empty());
  region(1, kSram3 + 0x20, kSize32K | kEnable);
  EXPECT_EQ(complaints.size(), 1U) << "no multiple of its size";
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator
