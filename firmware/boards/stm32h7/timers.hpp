// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/wide_counter.hpp"
#include "firmware/boards/stm32h7/cpu.hpp"
#include "firmware/boards/stm32h7/registers.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::stm32h7 {

/// Starts TIM5 as a counter of microseconds with 32 bits; it wraps after 71.6 min.
void start_microseconds();
inline std::uint32_t microseconds() {
  return reg(TIM5, tim::CNT);
}
/// Busy; for a few microseconds.
inline void wait_us(std::uint32_t us) {
  const std::uint32_t begin = microseconds();
  while (microseconds() - begin <= us) {
  }
}

/// 64 bits of microseconds since start_microseconds(). Any context.
class MicrosecondClock final : public hal::Clock {
 public:
  MicrosecondClock() { counter_.start(0); }
  hal::Time now() const override {
    return hal::Time{static_cast<std::int64_t>(counter_.at(microseconds))};
  }
  /// From the tick, so that no wrap is missed.
  void keep() { counter_.keep(microseconds()); }

 private:
  WideCounter counter_;
};

/// Timers and watchdog stand still while a debugger has halted the processor: it is not reset, and the outputs of
/// stopped timers end (RM0433 ch. 60: the DBGMCU). Before they are started.
void stop_with_debugger();

/// Starts TIM7: an interrupt every `period_us` microseconds in the bus context. The image forwards it to
/// clear_tick() first.
void start_tick(std::uint32_t period_us);
void clear_tick();

/// A square wave on channel 1 of a timer, for ever; the pin is the caller's.
/// @param period_us, high_us  < 65 536. Both 0: the pin stays low.
void start_square_wave(const Instance& timer, std::uint32_t period_us, std::uint32_t high_us);

/// The independent watchdog (IWDG1, on its own 32 kHz oscillator) resets the chip; TIM6 warns before,
/// as the most urgent interrupt, so that a record of where the processor hangs can be written.
class Watchdog {
 public:
  /// Once started it cannot be stopped. @param warning_us  < 65 536. @param reset_ms  < 4096
  static void start(std::uint32_t warning_us, std::uint32_t reset_ms);
  static void feed();
};

}  // namespace rosflight::boards::stm32h7
