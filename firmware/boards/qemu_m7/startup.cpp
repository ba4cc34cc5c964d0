// SPDX-License-Identifier: BSD-3-Clause
// From reset to board_main(): vector table, stack paint, variables, and what happens on a fault.
#include "firmware/boards/qemu_m7/startup.hpp"

#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/boards/qemu_m7/semihosting.hpp"

using namespace rosflight::boards::m7;  // NOLINT(google-build-using-namespace): symbols of the
                                        // linker

extern "C" {
extern std::uint32_t board_stack_bottom[], board_stack_top[];
extern std::uint32_t board_data_begin[], board_data_end[], board_data_load[];
extern std::uint32_t board_bss_begin[], board_bss_end[];
using Constructor = void (*)();
extern Constructor board_preinit_begin[], board_init_end[];

void Reset_Handler();
}

namespace {

constexpr std::uint32_t kPaint = 0xC0DE'FACEu;
constexpr std::uintptr_t kBootCount = 0x203F'FFF0u;  // in backup memory, which the reset leaves

/// A level stack pointer for the handler, whatever state the interrupted one is in.
__attribute__((naked)) void take_fault() {
  asm volatile(
      "tst lr, #4\n"
      "ite eq\n"
      "mrseq r0, msp\n"
      "mrsne r0, psp\n"
      "ldr r1, =board_fault_stack_top\n"
      "mov sp, r1\n"
      "b board_handle_fault\n");
}

}  // namespace

namespace rosflight::boards::m7 {

std::uint32_t stack_size() {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(board_stack_top) -
                                    reinterpret_cast<std::uintptr_t>(board_stack_bottom));
}

std::uint32_t stack_high_water() {
  const volatile std::uint32_t* word = board_stack_bottom;
  while (word < board_stack_top && *word == kPaint) ++word;
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
  reg(0xE000'ED88u) |= 0xFu << 20u;
  asm volatile("dsb\n isb" ::: "memory");

  // Painted once: a reset keeps the mark. Everything below this frame is free.
  if (board_stack_bottom[0] != kPaint) {
    const auto* const here = static_cast<const std::uint32_t*>(__builtin_frame_address(0));
    for (volatile std::uint32_t* word = board_stack_bottom; word < here - 16; ++word)
      *word = kPaint;
  }
  const std::uint32_t* source = board_data_load;
  for (volatile std::uint32_t* to = board_data_begin; to < board_data_end; ++to) *to = *source++;
  for (volatile std::uint32_t* to = board_bss_begin; to < board_bss_end; ++to) *to = 0;
  ++reg(kBootCount);
  for (Constructor* each = board_preinit_begin; each != board_init_end; ++each) (*each)();
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
