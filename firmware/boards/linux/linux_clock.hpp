// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>

#include "firmware/hal/roles.hpp"

namespace rosflight::boards {

/// The operating system's steady clock, counted from boot(): 64 bits of microseconds, never set
/// back.
class LinuxClock final : public hal::Clock {
 public:
  LinuxClock() : boot_{steady()} {}

  hal::Time now() const override { return steady() - boot_; }
  /// The processor starts again: time is zero.
  void boot() { boot_ = steady(); }
  /// The board's time at a moment of the steady clock.
  hal::Time at(hal::Time steady_time) const { return steady_time - boot_; }

  static hal::Time steady() {
    return std::chrono::duration_cast<hal::Time>(
        std::chrono::steady_clock::now().time_since_epoch());
  }

 private:
  hal::Time boot_;
};

}  // namespace rosflight::boards
