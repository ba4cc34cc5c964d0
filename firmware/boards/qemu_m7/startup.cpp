// SPDX-License-Identifier: BSD-3-Clause
// From reset to board_main(): vector table, stack paint, variables, and what happens on a fault.
#include "firmware/boards/qemu_m7/startup.hpp"

#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/boards/qemu_m7/semihosting.hpp"

// NOLINTBEGIN(google-build-using-namespace): symbols of the linker
using namespace rosflight::boards;
using namespace rosflight::boards::m7;
// NOLINTEND(google-build-using-namespace)

extern "C" {
void Reset_Handler();
}

namespace {

constexpr std::uintptr_t kBootCount = 0x203F'FFF0u;  // in backup memory, which the reset leaves

__attribute__((naked)) void take_fault() {
  ROSFLIGHT_TAKE_FAULT();
}

}  // namespace

namespace rosflight::boards::m7 {

std::uint32_t stack_size() {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(board_stack_top) -
                                    reinterpret_cast<std::uintptr_t>(board_stack_bottom));
}

std::uint32_t stack_high_water() {
  const volatile std::uint32_t* word = board_stack_bottom;
  while (word < board_stack_top && *word == kStackPaint) ++word;
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(board_stack_top) -
                                    reinterpret_cast<std::uintptr_t>(word));
}

std::uint32_t boot_count() {
  return reg(kBootCount);
}

}  // namespace rosflight::boards::m7

extern "C" {

__attribute__((weak)) void board_fault(const FaultRegisters& /*registers*/) {}
__attribute__((weak)) void board_tick() {}
__attribute__((weak)) void board_uart0_receive() {}
__attribute__((weak)) void board_uart0_transmit() {}
__attribute__((weak)) void board_uart1_receive() {}
__attribute__((weak)) void board_uart1_transmit() {}

[[noreturn]] __attribute__((used)) void board_handle_fault(const std::uint32_t* frame) {
  asm volatile("cpsid i" ::: "memory");
  board_fault(registers_at(frame));
  reset_processor();
}

[[noreturn]] __attribute__((used)) void board_start() {
  // Both coprocessors of the FPU, before any code that could touch a float register.
  reg(0xE000'ED88u) |= 0xFu << 20u;
  asm volatile("dsb\n isb" ::: "memory");

  // Painted once: a reset keeps the mark. Everything below this frame is free.
  if (board_stack_bottom[0] != kStackPaint) paint_stack(__builtin_frame_address(0));
  set_up_variables();
  ++reg(kBootCount);
  run_constructors();
  semihosting::exit(board_main());
}

__attribute__((naked)) void Reset_Handler() {
  asm volatile("b board_start");
}

struct VectorTable {
  const std::uint32_t* stack;
  void (*handlers[15 + 32])();
};

extern const VectorTable board_vectors;
__attribute__((section(".vectors"), used))
const VectorTable board_vectors = {board_stack_top,
                                   {
                                       Reset_Handler,
                                       take_fault,  // NMI: the watchdog
                                       take_fault,  // hard fault
                                       take_fault,  // memory management
                                       take_fault,  // bus
                                       take_fault,  // usage
                                       nullptr,
                                       nullptr,
                                       nullptr,
                                       nullptr,
                                       take_fault,  // SVC
                                       take_fault,  // debug monitor
                                       nullptr,
                                       take_fault,  // PendSV
                                       board_tick,
                                       board_uart0_receive,
                                       board_uart0_transmit,
                                       board_uart1_receive,
                                       board_uart1_transmit,
                                   }};
}
