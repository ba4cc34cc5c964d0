// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/boards/common/cortex_m7_startup.hpp"

/// What startup.cpp does for every image and what it expects of one. An image defines board_main()
/// and may define the handlers; by default they do nothing.
namespace rosflight::boards::m7 {

using boards::FaultRegisters;

/// Deepest the stack has been since the power came on [bytes]: it is painted once, then looked at.
std::uint32_t stack_high_water();
std::uint32_t stack_size();

/// Starts since the power came on, this one included.
std::uint32_t boot_count();

}  // namespace rosflight::boards::m7

extern "C" {
/// Runs when variables are set up; the emulator ends with the status it returns.
int board_main();
/// Called on a fault or when the watchdog bites, on a stack of its own, interrupts off; the board
/// resets when it returns. Default: nothing.
void board_fault(const rosflight::boards::FaultRegisters& registers);
void board_tick();
void board_uart0_receive();
void board_uart0_transmit();
void board_uart1_receive();
void board_uart1_transmit();
}
