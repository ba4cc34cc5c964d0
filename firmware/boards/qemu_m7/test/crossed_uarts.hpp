// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <vector>

#include "firmware/boards/qemu_m7/clocks.hpp"
#include "firmware/boards/qemu_m7/uart.hpp"

namespace rosflight::boards::m7 {

/// Busy for at least this long, by the cycle counter.
inline void spend(hal::Time time) {
  const auto wanted = static_cast<std::uint32_t>(time.count()) * (kClock_Hz / 1'000'000u);
  const std::uint32_t begin = cycles();
  while (cycles() - begin <= wanted) {
  }
}

/// UART 0 under test and UART 1 as its far end; on_target.sh wires them. One pair at a time.
class CrossedUarts {
 public:
  CrossedUarts();
  ~CrossedUarts();
  CrossedUarts(const CrossedUarts&) = delete;
  CrossedUarts& operator=(const CrossedUarts&) = delete;

  /// The far end sends; returns when all has arrived.
  void deliver(const std::vector<std::uint8_t>& bytes);
  /// Lets what is queued go out, which it does not before, and returns what arrived.
  std::vector<std::uint8_t> sent();

  Uart near{Uart::kUart0};
  Uart far{Uart::kUart1};
};

}  // namespace rosflight::boards::m7
