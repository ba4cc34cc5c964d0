// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <string>

#include "firmware/boards/stm32h7/emulator/clock_tree.hpp"
#include "firmware/boards/stm32h7/emulator/dma_model.hpp"
#include "firmware/boards/stm32h7/emulator/spi_model.hpp"
#include "firmware/boards/stm32h7/emulator/test/fake_core.hpp"
#include "firmware/boards/stm32h7/emulator/timer_model.hpp"
#include "firmware/boards/stm32h7/emulator/uart_model.hpp"

namespace rosflight::boards::stm32h7::emulator::testing {

inline constexpr std::uint64_t kCrystal_Hz = 24'000'000;

/// Clocks, DMA and one of each peripheral.
class Models : public ::testing::Test {
 protected:
  Models() {
    for (Peripheral* each :
         std::initializer_list<Peripheral*>{&flash, &power, &clocks, &multiplexer, &dma1, &dma2,
                                            &spi, &uart, &timer, &wide, &watchdog}) {
      each->reset();
    }
  }
  static void write(Peripheral& p, std::uint32_t offset, std::uint32_t value, unsigned size = 4) {
    p.bus_write(offset, value, size);
  }
  static std::uint32_t read(Peripheral& p, std::uint32_t offset, unsigned size = 4) {
    return p.bus_read(offset, size);
  }
  void expect_complaint(const std::string& part) {
    const std::string said = core.only_complaint();
    EXPECT_NE(said.find(part), std::string::npos) << "said: " << said;
  }
  /// As the firmware does it: see clocks.cpp of the chip layer.
  void start_clocks() {
    write(power, pwr::CR3, pwr::CR3_LDOEN(1));
    static_cast<void>(read(power, pwr::CSR1));
    write(power, pwr::D3CR, pwr::D3CR_VOS(3));
    write(clocks, rcc::CR, rcc::CR_HSION(1) | rcc::CR_HSEON(1));
    write(clocks, rcc::PLLCKSELR, 2U | 12U << 4U | 12U << 12U | 12U << 20U);
    write(clocks, rcc::PLLCFGR,
          rcc::PLLCFGR_PLL1RGE(1) | rcc::PLLCFGR_PLL2RGE(1) | rcc::PLLCFGR_PLL3RGE(1) |
              0x1FFU << 16U);
    write(clocks, rcc::PLL1DIVR, 399U | 1U << 9U | 7U << 16U | 1U << 24U);
    write(clocks, rcc::PLL2DIVR, 239U | 29U << 9U | 29U << 16U | 1U << 24U);
    write(clocks, rcc::CR, clocks_on);
    write(clocks, rcc::D1CFGR, rcc::D1CFGR_HPRE(8) | rcc::D1CFGR_D1PPRE(4));
    write(clocks, rcc::D2CFGR, rcc::D2CFGR_D2PPRE1(4) | rcc::D2CFGR_D2PPRE2(4));
    write(flash, flash::ACR, 2U | 2U << 4U);
    write(clocks, rcc::CFGR, 3);
    write(clocks, rcc::D2CCIP1R, rcc::D2CCIP1R_SPI45SEL(1));
  }

  static constexpr std::uint32_t clocks_on =
      rcc::CR_HSION(1) | rcc::CR_HSEON(1) | rcc::CR_PLL1ON(1) | rcc::CR_PLL2ON(1);
  static constexpr std::uint32_t kUartRx = request::USART2_RX, kUartTx = request::USART2_TX;
  FakeCore core;
  FlashControl flash{core};
  PowerControl power{core};
  ClockTree clocks{core, kCrystal_Hz, flash, power};
  DmaMultiplexer multiplexer{core};
  DmaModel dma1{core, "DMA1", DMA1, multiplexer, 0, {11, 12, 13, 14, 15, 16, 17, 47}};
  DmaModel dma2{core, "DMA2", DMA2, multiplexer, 8, {56, 57, 58, 59, 60, 68, 69, 70}};
  DmaRequests requests{{&dma1, &dma2}};
  SpiModel spi{core,   "SPI5",   SPI5,
               clocks, requests, {request::SPI5_RX, request::SPI5_TX, irq::SPI5}};
  UartModel uart{core, "USART2", USART2, clocks, requests, {kUartRx, kUartTx, irq::USART2}};
  TimerModel timer{core, "TIM1", TIM1, clocks, irq::TIM1_UP, TimerModel::Kind::kAdvanced};
  TimerModel wide{core, "TIM5", TIM5, clocks, irq::TIM5, TimerModel::Kind::kWide};
  WatchdogModel watchdog{core, clocks};
};

}  // namespace rosflight::boards::stm32h7::emulator::testing
