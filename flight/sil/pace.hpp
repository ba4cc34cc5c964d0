// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::flight {

/// Ticks at equal distances on a clock. A tick that comes up to kMaxDelay late is followed by the
/// next ones at full speed until the time is made up; a later one (busy machine, suspended computer, debugger)
/// moves to where it came, and all ticks behind it.
class Pace {
 public:
  /// Less than what the firmware takes for a wrong stamp of the IMU (50 ms, firmware/core/imu_clock.hpp): it would reject the samples.
  static constexpr hal::Time kMaxDelay = hal::milliseconds(40);

  /// The first tick is at `start`.
  Pace(hal::Time start, hal::Time step) : tick_{start}, step_{step} {}

  hal::Time tick() const { return tick_; }
  /// Serves the tick at `now`. @returns its time.
  hal::Time begin(hal::Time now) {
    if (now - tick_ > kMaxDelay) {
      tick_ = now;
      ++slips_;
    }
    return tick_;
  }
  /// On to the next.
  void advance() { tick_ += step_; }
  /// How often ticks have been moved.
  std::uint64_t slips() const { return slips_; }

 private:
  hal::Time tick_;
  hal::Time step_;
  std::uint64_t slips_{0};
};

}  // namespace rosflight::flight
