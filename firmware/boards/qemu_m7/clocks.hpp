// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/common/wide_counter.hpp"
#include "firmware/boards/qemu_m7/registers.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::boards::m7 {

/// Lock-step: shows the time that the exchange block brought, for the whole step.
class LatchedClock final : public hal::Clock {
 public:
  hal::Time now() const override { return now_; }
  void set(hal::Time now) { now_ = now; }

 private:
  hal::Time now_{};
};

/// Real time: microseconds since start, from the 25 MHz cycle counter.
class HardwareClock final : public hal::Clock {
 public:
  HardwareClock() { counter_.start(cycles()); }
  hal::Time now() const override {
    constexpr std::uint32_t kCyclesPerMicrosecond = kClock_Hz / 1'000'000u;
    return hal::Time{static_cast<std::int64_t>(counter_.at(cycles) / kCyclesPerMicrosecond)};
  }
  /// From the periodic interrupt, so that no wrap of the 32-bit counter is missed.
  void keep() { counter_.keep(cycles()); }

 private:
  WideCounter counter_;
};

}  // namespace rosflight::boards::m7
