// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

/// What the start of an image on the Cortex-M7 does on both microcontroller boards. For one source file of an image: the
/// startup.cpp of its board. Symbols named board_* are the linker script's.
namespace rosflight::boards {

/// r0, r1, r2, r3, r12, lr, pc, psr as the processor put them on the stack.
using FaultRegisters = std::array<std::uint32_t, 8>;

}  // namespace rosflight::boards

// NOLINTBEGIN(bugprone-dynamic-static-initializers): of the linker
extern "C" {
extern std::uint32_t board_stack_bottom[], board_stack_top[];
extern std::uint32_t board_data_begin[], board_data_end[], board_data_load[];
extern std::uint32_t board_bss_begin[], board_bss_end[];
using Constructor = void (*)();
extern Constructor board_preinit_begin[], board_init_end[];
}
// NOLINTEND(bugprone-dynamic-static-initializers)

namespace rosflight::boards {

inline constexpr std::uint32_t kStackPaint = 0xC0DE'FACEu;

/// Without a prologue, for a handler of faults: a level stack pointer, whatever state the interrupted one is in.
#define ROSFLIGHT_TAKE_FAULT()           \
  asm volatile(                          \
      "tst lr, #4\n"                     \
      "ite eq\n"                         \
      "mrseq r0, msp\n"                  \
      "mrsne r0, psp\n"                  \
      "ldr r1, =board_fault_stack_top\n" \
      "mov sp, r1\n"                     \
      "b board_handle_fault\n")

/// What the processor left at `frame`; zeros after a stack overflow, when there is nothing to read.
inline FaultRegisters registers_at(const std::uint32_t* frame) {
  FaultRegisters registers{};
  const auto at = reinterpret_cast<std::uintptr_t>(frame);
  if (at >= reinterpret_cast<std::uintptr_t>(board_stack_bottom) &&
      at + sizeof registers <= reinterpret_cast<std::uintptr_t>(board_stack_top)) {
    for (std::size_t k = 0; k < registers.size(); ++k) registers[k] = frame[k];
  }
  return registers;
}

/// All that is free below the caller's frame.
[[gnu::always_inline]] inline void paint_stack(const void* frame) {
  const auto* const here = static_cast<const std::uint32_t*>(frame);
  for (volatile std::uint32_t* word = board_stack_bottom; word < here - 16; ++word)
    *word = kStackPaint;
}

[[gnu::always_inline]] inline void set_up_variables() {
  const std::uint32_t* source = board_data_load;
  for (volatile std::uint32_t* to = board_data_begin; to < board_data_end; ++to) *to = *source++;
  for (volatile std::uint32_t* to = board_bss_begin; to < board_bss_end; ++to) *to = 0;
}

[[gnu::always_inline]] inline void run_constructors() {
  for (Constructor* each = board_preinit_begin; each != board_init_end; ++each) (*each)();
}

}  // namespace rosflight::boards
