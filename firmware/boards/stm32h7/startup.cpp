// SPDX-License-Identifier: BSD-3-Clause
// From reset to board_main(): floating point unit, stack paint, variables, and what happens on a fault.
#include "firmware/boards/stm32h7/startup.hpp"

#include "firmware/boards/stm32h7/cpu.hpp"

// NOLINTBEGIN(google-build-using-namespace): symbols of the linker
using namespace rosflight::boards;
using namespace rosflight::boards::stm32h7;
// NOLINTEND(google-build-using-namespace)

extern "C" {
extern const VectorTable board_vectors;

/// Which board the image is for: the emulator, and a person with a debugger, find it by its name.
extern const char board_name[];
__attribute__((used)) const char board_name[] = ROSFLIGHT_BOARD;

__attribute__((naked)) void board_take_fault() {
  ROSFLIGHT_TAKE_FAULT();
}

[[noreturn]] __attribute__((used)) void board_handle_fault(const std::uint32_t* frame) {
  asm volatile("cpsid i" ::: "memory");
  board_fault(registers_at(frame));
  reset_processor();
}

[[noreturn]] __attribute__((used)) void board_start() {
  // Both coprocessors of the FPU, before any code that could touch a float register.
  memory_at<volatile std::uint32_t>(0xE000'ED88u) = 0xFu << 20u;
  asm volatile("dsb\n isb" ::: "memory");

  // A bootloader that started this image has a table of its own.
  memory_at<volatile std::uint32_t>(0xE000'ED08u) =
      reinterpret_cast<std::uintptr_t>(&board_vectors);

  paint_stack(__builtin_frame_address(0));
  set_up_variables();
  run_constructors();
  board_main();
}

__attribute__((naked)) void Reset_Handler() {
  asm volatile("b board_start");
}
}
