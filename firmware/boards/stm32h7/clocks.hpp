// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/boards/stm32h7/registers.hpp"

namespace rosflight::boards::stm32h7 {

// What start_clocks() sets up.
inline constexpr std::uint32_t kCoreClock_Hz = 400'000'000;
inline constexpr std::uint32_t kTimerClock_Hz = 200'000'000;
inline constexpr std::uint32_t kBusClock_Hz = 100'000'000;  ///< APB: UARTs, I2C.
inline constexpr std::uint32_t kSpiClock_Hz = 64'000'000;   ///< Kernel clock of SPI1 to SPI5.

/// The board's oscillator at HSE.
struct Oscillator {
  std::uint32_t frequency_MHz;  ///< Even, 4 to 126.
  bool external_clock;          ///< A clock signal instead of a crystal.
};

/// Supply, oscillators and PLLs from the state after a reset: 400 MHz from PLL1, 64 MHz for SPI from
/// PLL2, 48 MHz (USB) and 64 MHz (ADC) from PLL3. RM0433 ch. 6 and 8.
/// Waits for the oscillators, some 2 ms, without a limit: without a clock no part of the board works.
void start_clocks(const Oscillator& oscillator);

/// Memory of section .dma, as an instance: it has a clock gate too.
inline constexpr Instance kSram3{0x3004'0000u, rcc::AHB2ENR, rcc::AHB2ENR_SRAM3EN.lsb};

/// Opens the clock gate of a peripheral and reads it back: the gate takes effect two bus clocks after
/// the write.
void open_gate(const Instance& instance);

}  // namespace rosflight::boards::stm32h7
