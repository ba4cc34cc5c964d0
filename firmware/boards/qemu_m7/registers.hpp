// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/boards/common/cortex_m7.hpp"

/// Registers of the Cortex-M7 (Armv7-M Architecture Reference Manual, DDI 0403E, part B3) and of
/// the Arm MPS2 board that qemu calls mps2-an500 (Arm Cortex-M System Design Kit, DDI 0479D: UART
/// ch. 4.3, watchdog 4.5; Arm MPS2 FPGA board manual: FPGAIO). The only file that knows addresses.
namespace rosflight::boards::m7 {

using boards::memory_barrier;
using boards::wait_for_interrupt;

inline constexpr std::uint32_t kClock_Hz = 25'000'000;

/// What the hardware has there: the one place where a number becomes a pointer.
template <typename T>
T& memory_at(std::uintptr_t address) {
  return *reinterpret_cast<T*>(address);  // NOLINT(performance-no-int-to-ptr)
}

inline volatile std::uint32_t& reg(std::uintptr_t address) {
  return memory_at<volatile std::uint32_t>(address);
}

// ---- interrupt controller, reset
inline void enable_interrupt(unsigned irq) {
  reg(0xE000E100u + 4u * (irq / 32u)) = 1u << (irq % 32u);
}
inline void disable_interrupt(unsigned irq) {
  reg(0xE000E180u + 4u * (irq / 32u)) = 1u << (irq % 32u);
  asm volatile("dsb\n isb" ::: "memory");
}
/// The handler runs as soon as it is enabled.
inline void pend_interrupt(unsigned irq) {
  reg(0xE000E200u + 4u * (irq / 32u)) = 1u << (irq % 32u);
}

[[noreturn]] inline void reset_processor() {
  constexpr std::uint32_t kKey = 0x05FA'0000u;
  constexpr std::uint32_t kSystemReset = 1u << 2u;
  asm volatile("dsb" ::: "memory");
  reg(0xE000ED0Cu) = kKey | kSystemReset;
  for (;;) asm volatile("dsb" ::: "memory");
}

// ---- SysTick: a periodic interrupt
inline void start_tick(std::uint32_t rate_Hz) {
  constexpr std::uint32_t kCoreClockInterruptEnable = 7u;
  reg(0xE000E014u) = kClock_Hz / rate_Hz - 1u;
  reg(0xE000E018u) = 0;
  reg(0xE000E010u) = kCoreClockInterruptEnable;
}

// ---- FPGAIO: LEDs, and a free-running counter of clock cycles (32 bits: 171 s)
inline constexpr std::uintptr_t kLedRegister = 0x4002'8000u;
inline constexpr std::uintptr_t kCycleCounter = 0x4002'8018u;
inline std::uint32_t cycles() {
  return reg(kCycleCounter);
}

// ---- CMSDK watchdog: the first timeout is a non-maskable interrupt, the second resets
class Watchdog {
 public:
  /// Starts it, or starts it again from the full time.
  static void start(std::uint32_t timeout_ms) {
    unlock();
    reg(kLoad) = kClock_Hz / 1000u * timeout_ms;
    reg(kControl) = kInterruptAndReset;
  }
  static void feed(std::uint32_t timeout_ms) { reg(kLoad) = kClock_Hz / 1000u * timeout_ms; }
  static void stop() {
    unlock();
    reg(kControl) = 0;
  }

 private:
  static constexpr std::uintptr_t kLoad = 0x4000'8000u;
  static constexpr std::uintptr_t kControl = 0x4000'8008u;
  static constexpr std::uintptr_t kLock = 0x4000'8C00u;
  static constexpr std::uint32_t kInterruptAndReset = 3u;
  static void unlock() { reg(kLock) = 0x1ACC'E551u; }
};

}  // namespace rosflight::boards::m7
