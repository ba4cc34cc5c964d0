// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware/boards/common/cortex_m7_startup.hpp"

/// What startup.cpp does for every image and what it expects of one: board_main(), board_fault() and
/// `board_vectors`, the table of its interrupts.
namespace rosflight::boards::stm32h7 {

using boards::FaultRegisters;

using Handler = void (*)();
struct Interrupt {
  unsigned irq;
  Handler handler;
};

struct VectorTable {
  static constexpr std::size_t kIrqs = 150;
  const std::uint32_t* stack;
  Handler system[15];
  Handler irqs[kIrqs];
};

}  // namespace rosflight::boards::stm32h7

extern "C" {
void Reset_Handler();  // NOLINT(readability-identifier-naming): the linker's entry
/// Every fault, every interrupt without a handler, and the watchdog's warning.
void board_take_fault();
/// Runs when variables are set up.
[[noreturn]] void board_main();
/// Called on a fault, on a stack of its own, interrupts off; the chip resets when it returns.
void board_fault(const rosflight::boards::FaultRegisters& registers);
}

namespace rosflight::boards::stm32h7 {

template <std::size_t N>
constexpr VectorTable make_vectors(const Interrupt (&interrupts)[N]) {
  VectorTable table{};
  table.stack = board_stack_top;
  for (Handler& each : table.system) each = board_take_fault;
  for (Handler& each : table.irqs) each = board_take_fault;
  table.system[0] = Reset_Handler;
  for (const Interrupt& each : interrupts) table.irqs[each.irq] = each.handler;
  return table;
}

}  // namespace rosflight::boards::stm32h7
