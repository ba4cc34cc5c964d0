// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

/// Instructions of the processor, which the two microcontroller boards have in common.
namespace rosflight::boards {

inline void memory_barrier() {
  asm volatile("dmb" ::: "memory");
}

/// Sleeps until an interrupt is pending. Call it with interrupts masked, so that none slips in between
/// the last look and the sleep: one that is masked wakes too.
inline void wait_for_interrupt() {
  asm volatile("dsb\n wfi" ::: "memory");
}

/// All interrupts off while this lives.
class InterruptGuard {
 public:
  InterruptGuard() { asm volatile("mrs %0, primask\n cpsid i" : "=r"(was_masked_)::"memory"); }
  ~InterruptGuard() {
    if (was_masked_ == 0) asm volatile("cpsie i" ::: "memory");
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  std::uint32_t was_masked_{};
};

}  // namespace rosflight::boards
