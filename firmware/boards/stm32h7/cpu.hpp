// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/boards/common/cortex_m7.hpp"
#include "firmware/boards/stm32h7/register.hpp"

/// The Cortex-M7 of the chip: interrupt controller, caches, memory protection. Addresses:
/// Armv7-M Architecture Reference Manual (DDI 0403E) part B3.
namespace rosflight::boards::stm32h7 {

/// Priorities in use, lower is more urgent (four bits).
enum class Priority : std::uint8_t {
  kWarning = 0,  ///< The watchdog's warning.
  kEdge = 1,     ///< Notes the time of an edge and nothing else.
  kBus = 5       ///< The bus context of firmware/boards/parts: all drivers.
};

/// The bus context off; edges still get their time. @returns what unmask_bus() restores.
inline std::uint32_t mask_bus() {
  std::uint32_t before = 0;
  constexpr std::uint32_t kBasePriority = static_cast<std::uint32_t>(Priority::kBus) << 4u;
  asm volatile("mrs %0, basepri\n msr basepri_max, %1\n isb"
               : "=&r"(before)
               : "r"(kBasePriority)
               : "memory");
  return before;
}
inline void unmask_bus(std::uint32_t before) {
  asm volatile("msr basepri, %0" ::"r"(before) : "memory");
}

// ---- interrupt controller, reset
inline void enable_interrupt(unsigned irq, Priority priority) {
  constexpr std::uintptr_t kPriorities = 0xE000'E400u, kSetEnable = 0xE000'E100u;
  memory_at<volatile std::uint8_t>(kPriorities + irq) =
      static_cast<std::uint8_t>(static_cast<unsigned>(priority) << 4u);
  memory_at<volatile std::uint32_t>(kSetEnable + 4u * (irq / 32u)) = 1u << (irq % 32u);
}
inline void pend_interrupt(unsigned irq) {
  memory_at<volatile std::uint32_t>(0xE000'E200u + 4u * (irq / 32u)) = 1u << (irq % 32u);
}
[[noreturn]] inline void reset_processor() {
  constexpr std::uint32_t kKey = 0x05FA'0000u, kSystemReset = 1u << 2u;
  asm volatile("dsb" ::: "memory");
  memory_at<volatile std::uint32_t>(0xE000'ED0Cu) = kKey | kSystemReset;
  for (;;) asm volatile("dsb" ::: "memory");
}

// ---- memory protection unit and caches

/// Makes a region of memory normal, shareable and so not cached by this core; for what DMA touches and
/// for what must survive a reset. `size` is a power of two of 32 or more, `base` a multiple of it.
void make_uncached(unsigned region, std::uint32_t base, std::uint32_t size);
/// Switches the MPU on, the default map for the rest, and then both caches.
void start_memory_system();
/// Silicon of revision Y: reads of the AXI SRAM may be wrong beside writes unless its port issues one at a time
/// (errata sheet ES0392). Before that memory is used.
void repair_old_silicon();

}  // namespace rosflight::boards::stm32h7
