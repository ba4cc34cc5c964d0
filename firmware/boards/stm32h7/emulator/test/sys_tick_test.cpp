// SPDX-License-Identifier: BSD-3-Clause
// SysTick and the fault registers of the processor. Armv7-M ARM (DDI 0403E) B3.3 and B3.2.15.
#include "firmware/boards/stm32h7/emulator/sys_tick.hpp"

#include "firmware/boards/stm32h7/emulator/system_control.hpp"
#include "firmware/boards/stm32h7/emulator/test/fake_core.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

constexpr Ticks kCycle = 2;
constexpr std::uint32_t kOn = SysTick::kEnable | SysTick::kOfProcessor;

class Tick : public ::testing::Test {
 protected:
  Tick() {
    tick.reset();
    tick.set_cycle(kCycle);
  }
  /// How often it asked in this many cycles; each request is served at once.
  int requests(Ticks cycles) {
    int count = 0;
    for (Ticks k = 0; k < cycles; ++k) {
      core.run_for(kCycle);
      if (!nvic.pending(kSysTick)) continue;
      ++count;
      nvic.unpend(kSysTick);
    }
    return count;
  }
  FakeCore core;
  Nvic nvic;
  SysTick tick{core, nvic};
};

TEST_F(Tick, AsksOnceInReloadAndOneCycles) {
  tick.write(SysTick::kReload, 99);
  tick.write(SysTick::kValue, 7);
  tick.write(SysTick::kControl, kOn | SysTick::kInterrupt);
  EXPECT_EQ(requests(99), 0);
  EXPECT_EQ(requests(1), 1);
  EXPECT_EQ(requests(1000), 10);
}

TEST_F(Tick, CountsDownAndShowsThatItWrappedOnce) {
  tick.write(SysTick::kReload, 9);
  tick.write(SysTick::kValue, 0);
  tick.write(SysTick::kControl, kOn);
  core.run_for(kCycle);
  EXPECT_EQ(tick.read(SysTick::kValue), 9U);
  core.run_for(3 * kCycle);
  EXPECT_EQ(tick.read(SysTick::kValue), 6U);
  EXPECT_EQ(tick.read(SysTick::kControl) & SysTick::kWrapped, 0U);
  core.run_for(6 * kCycle);
  EXPECT_EQ(tick.read(SysTick::kControl) & SysTick::kWrapped, SysTick::kWrapped);
  EXPECT_EQ(tick.read(SysTick::kControl) & SysTick::kWrapped, 0U) << "reading has cleared it";
  EXPECT_FALSE(nvic.pending(kSysTick)) << "no interrupt was asked for";
}

TEST_F(Tick, StandsStillWhileItIsOffOrHasNoReloadValue) {
  tick.write(SysTick::kControl, kOn | SysTick::kInterrupt);
  EXPECT_EQ(requests(100), 0) << "reload value 0";
  tick.write(SysTick::kReload, 9);
  EXPECT_GT(requests(100), 5);
  tick.write(SysTick::kControl, 0);
  EXPECT_EQ(requests(100), 0);
}

TEST_F(Tick, AnotherClockIsComplainedOf) {
  tick.write(SysTick::kReload, 9);
  tick.write(SysTick::kControl, SysTick::kEnable);
  EXPECT_NE(core.only_complaint().find("SysTick"), std::string::npos);
}

constexpr std::uint32_t kScs = 0xE000, kShcsr = kScs + 0xD24, kCfsr = kScs + 0xD28,
                        kHfsr = kScs + 0xD2C, kMmfar = kScs + 0xD34, kBfar = kScs + 0xD38;

class Faults : public ::testing::Test {
 protected:
  Faults() { control.reset(0x0800'0000); }
  Nvic nvic;
  SystemControl control{nvic, [](const std::string&) {}};
};

TEST_F(Faults, StatusStaysUntilAOneIsWritten) {
  control.note_fault(0x8200, 1U << 30U, 0x6000'0000);
  EXPECT_EQ(control.read(kCfsr, 0), 0x8200U);
  EXPECT_EQ(control.read(kHfsr, 0), 1U << 30U);
  EXPECT_EQ(control.read(kBfar, 0), 0x6000'0000U);
  EXPECT_EQ(control.read(kMmfar, 0), 0U);
  control.note_fault(1U << 16U, 0, 0);
  EXPECT_EQ(control.read(kCfsr, 0), 0x1'8200U) << "statuses add up";
  control.write(kCfsr, 0x8000, 4, 0);
  EXPECT_EQ(control.read(kCfsr, 0), 0x1'0200U);
  control.write(kHfsr, ~0U, 4, 0);
  EXPECT_EQ(control.read(kHfsr, 0), 0U);
}

TEST_F(Faults, AMemoryFaultHasAnAddressOfItsOwn) {
  control.note_fault(0x82, 0, 0x2000'0400);
  EXPECT_EQ(control.read(kMmfar, 0), 0x2000'0400U);
  EXPECT_EQ(control.read(kBfar, 0), 0U);
}

TEST_F(Faults, HaveHandlersOfTheirOwnOnceEnabled) {
  for (const int exception : {kMemoryFault, kBusFault, kUsageFault}) {
    EXPECT_FALSE(control.fault_enabled(exception));
    control.write(kShcsr, 1U << (12 + exception), 4, 0);
    EXPECT_TRUE(control.fault_enabled(exception));
    control.write(kShcsr, 0, 4, 0);
  }
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
