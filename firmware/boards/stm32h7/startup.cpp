// SPDX-License-Identifier: BSD-3-Clause
// From reset to board_main(): floating point unit, stack paint, variables, and what happens on a fault.
#include "firmware/boards/stm32h7/startup.hpp"

#include "firmware/boards/stm32h7/cpu.hpp"

using namespace rosflight::boards::stm32h7;  // NOLINT(google-build-using-namespace): symbols of the
                                             // linker

extern "C" {
extern std::uint32_t board_stack_bottom[];
extern std::uint32_t board_data_begin[], board_data_end[], board_data_load[];
extern const VectorTable board_vectors;
extern std::uint32_t board_bss_begin[], board_bss_end[];
using Constructor = void (*)();
extern Constructor board_preinit_begin[], board_init_end[];

/// A level stack pointer for the handler, whatever state the interrupted one is in.
__attribute__((naked)) void board_take_fault() {
  asm volatile(
      "tst lr, #4\n"
      "ite eq\n"
      "mrseq r0, msp\n"
      "mrsne r0, psp\n"
      "ldr r1, =board_fault_stack_top\n"
      "mov sp, r1\n"
      "b board_handle_fault\n");
}

[[noreturn]] __attribute__((used)) void board_handle_fault(const std::uint32_t* frame) {
  asm volatile("cpsid i" ::: "memory");
  FaultRegisters registers{};
  // After a stack overflow there is no frame to read.
  const auto at = reinterpret_cast<std::uintptr_t>(frame);
  if (at >= reinterpret_cast<std::uintptr_t>(board_stack_bottom) &&
      at + sizeof registers <= reinterpret_cast<std::uintptr_t>(board_stack_top)) {
    for (std::size_t k = 0; k < registers.size(); ++k) registers[k] = frame[k];
  }
  board_fault(registers);
  reset_processor();
}

[[noreturn]] __attribute__((used)) void board_start() {
  // Both coprocessors of the FPU, before any code that could touch a float register.
  memory_at<volatile std::uint32_t>(0xE000'ED88u) = 0xFu << 20u;
  asm volatile("dsb\n isb" ::: "memory");

  // A bootloader that started this image has a table of its own.
  memory_at<volatile std::uint32_t>(0xE000'ED08u) =
      reinterpret_cast<std::uintptr_t>(&board_vectors);

  // Everything below this frame is free.
  const auto* const here = static_cast<const std::uint32_t*>(__builtin_frame_address(0));
  constexpr std::uint32_t kPaint = 0xC0DE'FACEu;
  for (volatile std::uint32_t* word = board_stack_bottom; word < here - 16; ++word) *word = kPaint;
  const std::uint32_t* source = board_data_load;
  for (volatile std::uint32_t* to = board_data_begin; to < board_data_end; ++to) *to = *source++;
  for (volatile std::uint32_t* to = board_bss_begin; to < board_bss_end; ++to) *to = 0;
  for (Constructor* each = board_preinit_begin; each != board_init_end; ++each) (*each)();
  board_main();
}

__attribute__((naked)) void Reset_Handler() {
  asm volatile("b board_start");
}
}
