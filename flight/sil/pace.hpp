// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::flight {

/// Ticks at equal distances on a clock. A tick that comes up to kMaxDelay late is followed by the
/// next ones at full speed until the time is made up; a later one (suspended computer, debugger)
/// moves all ticks behind it.
class Pace {
 public:
  static constexpr hal::Time kMaxDelay = hal::milliseconds(100);

  /// The first tick is at `start`.
  Pace(hal::Time start, hal::Time step) : tick_{start}, step_{step} {}

  hal::Time tick() const { return tick_; }
  /// The tick has been served at `now`; on to the next.
  void advance(hal::Time now) {
    if (now - tick_ > kMaxDelay) {
      tick_ = now;
      ++slips_;
    }
    tick_ += step_;
  }
  /// How often ticks have been moved.
  std::uint64_t slips() const { return slips_; }

 private:
  hal::Time tick_;
  hal::Time step_;
  std::uint64_t slips_{0};
};

}  // namespace rosflight::flight
