// SPDX-License-Identifier: BSD-3-Clause
// Each rule of the chip: a driver that keeps it is not complained of, one that breaks it is.
// Registers, clocks, watchdog, timers and pins.
#include <gtest/gtest.h>

#include "firmware/boards/stm32h7/emulator/pins.hpp"
#include "firmware/boards/stm32h7/emulator/test/models_rig.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {
namespace {

// ---- registers

TEST_F(Models, UnknownRegistersAndReservedBitsAreComplainedOf) {
  write(watchdog, 0x14, 0);
  expect_complaint("no register");
  static_cast<void>(read(clocks, 0x200));
  expect_complaint("no register");
  write(uart, usart::BRR, 0x1'0000);
  expect_complaint("reserved bits 0x10000 at offset 0xc");
}

TEST_F(Models, ABusErrorIsInjectedOnce) {
  spi.fail_next_write();
  write(spi, spi::CR1, spi::CR1_SSI(1));
  write(spi, spi::CR1, spi::CR1_SSI(1));
  EXPECT_EQ(core.bus_errors, 1);
  EXPECT_EQ(read(spi, spi::CR1), spi::CR1_SSI(1));
}

// ---- clocks

TEST_F(Models, ClocksOfTheBoardComeOutAsInTheReferenceManual) {
  start_clocks();
  EXPECT_EQ(core.complaints, std::vector<std::string>{});
  EXPECT_EQ(clocks.core_Hz(), 400'000'000U);
  EXPECT_EQ(clocks.apb_Hz(), 100'000'000U);
  EXPECT_EQ(clocks.timer_period(), 4U) << "5 ns at 200 MHz";
  EXPECT_EQ(clocks.spi_Hz(SPI5), 16'000'000U);
}

TEST_F(Models, PllIsSetUpOnlyWhileItStandsAndInItsRange) {
  start_clocks();
  write(clocks, rcc::PLL1DIVR, 300U | 1U << 9U);
  expect_complaint("PLL1 is set up while it runs");
  clocks.reset();
  core.complaints.clear();
  write(clocks, rcc::PLLCKSELR, 2U | 3U << 4U);  // 8 MHz, in the range field of 1 to 2 MHz
  write(clocks, rcc::PLL1DIVR, 99U | 1U << 9U);
  write(clocks, rcc::CR, rcc::CR_HSEON(1) | rcc::CR_PLL1ON(1));
  expect_complaint("outside of its range field");
}

TEST_F(Models, FastClockNeedsWaitStatesAndVoltage) {
  start_clocks();
  write(flash, flash::ACR, 0);
  write(clocks, rcc::CFGR, 0);
  write(clocks, rcc::CFGR, 3);
  expect_complaint("wait states");
  write(flash, flash::ACR, 2);
  write(power, pwr::D3CR, pwr::D3CR_VOS(1));
  write(clocks, rcc::CFGR, 3);
  expect_complaint("voltage scale 1");
}

TEST_F(Models, SupplyIsChosenOnce) {
  write(power, pwr::CR3, pwr::CR3_LDOEN(1));
  write(power, pwr::CR3, pwr::CR3_BYPASS(1));
  expect_complaint("only once");
}

TEST_F(Models, VoltageScaleWaitsForTheSupply) {
  write(power, pwr::CR3, pwr::CR3_LDOEN(1));
  write(power, pwr::D3CR, pwr::D3CR_VOS(3));
  expect_complaint("before ACTVOSRDY was read");
}

TEST_F(Models, GateIsReadBackBeforeTheFirstAccess) {
  EXPECT_FALSE(clocks.gate_open(SPI5));
  write(clocks, rcc::APB2ENR, rcc::APB2ENR_SPI5EN(1));
  static_cast<void>(read(clocks, rcc::APB2ENR));
  EXPECT_TRUE(clocks.gate_open(SPI5));
  EXPECT_TRUE(core.complaints.empty());
  write(clocks, rcc::APB2ENR, rcc::APB2ENR_SPI5EN(1) | rcc::APB2ENR_TIM1EN(1));
  EXPECT_TRUE(clocks.gate_open(TIM1));
  expect_complaint("not read back");
}

// ---- watchdog

TEST_F(Models, WatchdogResetsAfterItsTimeUnlessItIsFed) {
  write(watchdog, iwdg::KR, 0xCCCC);
  write(watchdog, iwdg::KR, 0x5555);
  write(watchdog, iwdg::PR, 3);  // divided by 32: 1 ms
  write(watchdog, iwdg::RLR, 99);
  write(watchdog, iwdg::KR, 0xAAAA);
  core.run_for(99'000 * kTicksPerMicrosecond);
  write(watchdog, iwdg::KR, 0xAAAA);
  core.run_for(99'000 * kTicksPerMicrosecond);
  EXPECT_EQ(core.resets, 0);
  core.run_for(2'000 * kTicksPerMicrosecond);
  EXPECT_EQ(core.resets, 1);
  EXPECT_TRUE(core.complaints.empty());
  write(watchdog, iwdg::PR, 0);
  expect_complaint("without the key");
}

// ---- timers

TEST_F(Models, PrescalerTakesEffectAtAnUpdate) {
  start_clocks();
  write(wide, tim::PSC, 199);
  write(wide, tim::CR1, tim::CR1_CEN(1));
  core.run_for(10 * kTicksPerMicrosecond);
  EXPECT_EQ(read(wide, tim::CNT), 2000U) << "no update yet: it counts at 200 MHz";
  write(wide, tim::EGR, tim::EGR_UG(1));
  core.run_for(10 * kTicksPerMicrosecond);
  EXPECT_EQ(read(wide, tim::CNT), 10U);
}

TEST_F(Models, PulseChangesWithThePeriodAndNeedsTheMainOutput) {
  start_clocks();
  write(timer, tim::PSC, 199);
  write(timer, tim::ARR, 2499);
  write(timer, tim::CCMR1, tim::CCMR1_OC1M(6) | tim::CCMR1_OC1PE(1));
  write(timer, tim::CCER, tim::CCER_CC1E(1));
  write(timer, tim::CCR1, 1500);
  write(timer, tim::EGR, tim::EGR_UG(1));
  write(timer, tim::CR1, tim::CR1_CEN(1));
  EXPECT_EQ(timer.pulse(0), 0U) << "TIM1 without MOE drives no pin";
  write(timer, tim::BDTR, tim::BDTR_MOE(1));
  EXPECT_EQ(timer.pulse(0), 1500 * kTicksPerMicrosecond);
  write(timer, tim::CCR1, 1200);
  EXPECT_EQ(timer.pulse(0), 1500 * kTicksPerMicrosecond) << "the pulse under way is not cut";
  core.run_for(2500 * kTicksPerMicrosecond);
  EXPECT_EQ(timer.pulse(0), 1200 * kTicksPerMicrosecond);
  EXPECT_TRUE(core.complaints.empty());
}

TEST_F(Models, AForcedOutputIsALevelOnceItDrivesThePin) {
  start_clocks();
  write(timer, tim::CCMR2, tim::CCMR2_OC4M(5));
  EXPECT_TRUE(timer.forces(3));
  EXPECT_FALSE(timer.forced_high(3)) << "not enabled";
  write(timer, tim::CCER, tim::CCER_CC4E(1));
  EXPECT_FALSE(timer.forced_high(3)) << "TIM1 without MOE drives no pin";
  write(timer, tim::BDTR, tim::BDTR_MOE(1));
  EXPECT_TRUE(timer.forced_high(3)) << "at once, although the counter stands still";
  EXPECT_EQ(timer.pulse(3), 0U);
  write(timer, tim::CCMR2, tim::CCMR2_OC4M(4));
  EXPECT_TRUE(timer.forces(3));
  EXPECT_FALSE(timer.forced_high(3));
  EXPECT_FALSE(timer.forces(2)) << "the other channel of the register";
  EXPECT_TRUE(core.complaints.empty());
}

// ---- pins

TEST(Pins, EdgeReachesTheInterruptOfItsPortAlone) {
  FakeCore core;
  SystemConfiguration configuration{core};
  ExternalInterrupts interrupts{core, configuration};
  PinPort f{core, 5, GPIOF, interrupts}, a{core, 0, GPIOA, interrupts};
  for (Peripheral* each : std::initializer_list<Peripheral*>{&configuration, &interrupts, &f, &a})
    each->reset();
  configuration.bus_write(syscfg::EXTICR1, 5U << 12U, 4);  // line 3: port F
  interrupts.bus_write(exti::RTSR1, 1U << 3U, 4);
  interrupts.bus_write(exti::CPUIMR1, 1U << 3U, 4);
  a.drive(3, true);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 0U);
  f.drive(3, true);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 1U);
  interrupts.bus_write(exti::CPUPR1, 1U << 3U, 4);
  f.drive(3, false);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 0U) << "a falling edge was not asked for";
  interrupts.stick(3);
  interrupts.bus_write(exti::CPUPR1, 1U << 3U, 4);
  EXPECT_EQ(core.lines.count(irq::EXTI3), 1U) << "injected: it stays";
}

TEST(Pins, WrongFunctionIsComplainedOf) {
  FakeCore core;
  SystemConfiguration configuration{core};
  ExternalInterrupts interrupts{core, configuration};
  PinPort d{core, 3, GPIOD, interrupts};
  d.reset();
  d.bus_write(gpio::AFR0, 7U << 20U, 4);
  d.expect_alternate(5, 7);
  EXPECT_NE(core.only_complaint().find("GPIOD: pin 5"), std::string::npos)
      << "not in alternate mode yet";
  d.bus_write(gpio::MODER, 2U << 10U, 4);
  d.expect_alternate(5, 7);
  EXPECT_TRUE(core.complaints.empty());
  d.expect_alternate(5, 8);
  EXPECT_EQ(core.complaints.size(), 1U);
}

}  // namespace
}  // namespace rosflight::boards::stm32h7::emulator::testing
