// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <cstdint>

#include "sim/types.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// Finds the regular ticks behind stamps that come a little early or late.
///
/// Instruments take their turns at multiples of their period. Fed with stamps of a wall clock, a
/// tick 30 us early would miss its turn and the next one would stand for two. This rounds to whole
/// ticks since the first stamp, less the mean lateness seen so far,
///
///     n = round((s - b)/T),   b <- b + ((s - b) - n T)/64
///
/// so ticks keep their distance while jitter stays below T/2.
class TickTracker {
 public:
  explicit TickTracker(std::int64_t period_ns) : period_ns_{static_cast<double>(period_ns)} {}

  /// @returns whether a new tick has come; time() is then its time. A stamp that lies more than a
  /// second before the last one restarts: somebody set the clock back.
  bool step(std::int64_t stamp_ns) {
    constexpr std::int64_t kSetBack_ns = 1'000'000'000;
    if (!started_ || stamp_ns < last_stamp_ns_ - kSetBack_ns) {
      first_ns_ = stamp_ns - static_cast<std::int64_t>(static_cast<double>(tick_ + 1) * period_ns_);
      if (!started_) first_ns_ = stamp_ns;
      tick_ += started_ ? 1 : 0;
      bias_ns_ = 0.0;
      started_ = true;
      last_stamp_ns_ = stamp_ns;
      return true;
    }
    last_stamp_ns_ = stamp_ns;
    constexpr double kSlowness = 64.0;
    const double at = static_cast<double>(stamp_ns - first_ns_) - bias_ns_;
    const std::int64_t tick = std::llround(at / period_ns_);
    bias_ns_ += (at - static_cast<double>(tick) * period_ns_) / kSlowness;
    if (tick <= tick_) return false;
    tick_ = tick;
    return true;
  }

  /// Time of the last tick since the first.
  sim::Time time() const {
    constexpr double kMicrosecond_ns = 1000.0;
    return sim::Time{std::llround(static_cast<double>(tick_) * period_ns_ / kMicrosecond_ns)};
  }

 private:
  double period_ns_;
  bool started_{false};
  std::int64_t first_ns_{0};
  std::int64_t last_stamp_ns_{0};
  std::int64_t tick_{0};
  double bias_ns_{0.0};
};

}  // namespace rosflight_sim
