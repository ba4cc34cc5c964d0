// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/hal/time.hpp"

namespace rosflight::core {

using hal::Time;

/// Timing of the main loop: passes, the longest pass, passes above the budget, and the jitter of IMU
/// samples.
class PassCounters {
 public:
  /// Four fifths of the period of a 400 Hz IMU; the rest is for interrupts.
  static constexpr Time kBudget = hal::microseconds(2000);
  static constexpr std::size_t kJitterBins = 8;
  /// Upper ends of the bins; the last one has none.
  static constexpr std::array<std::int64_t, kJitterBins - 1> kJitterEnds_us{10,   30,   100,  300,
                                                                            1000, 3000, 10000};

  /// Counts a pass that used the processor for `busy`. A pass that wrote to storage is expected to be
  /// slow and does not count for in_time().
  void pass(Time now, Time busy, bool stored) {
    ++passes_;
    longest_ = std::max(longest_, busy);
    if (busy <= kBudget) return;
    ++over_budget_;
    if (!stored) slow_.add(now);
  }
  /// Counts the jitter of an IMU sample: the change of arrival less stamp since the previous one.
  void imu(Time now, Time stamp) {
    const Time delay = now - stamp;
    const std::int64_t jitter = std::abs((delay - delay_).count());
    delay_ = delay;
    std::size_t bin = 0;
    while (bin < kJitterEnds_us.size() && jitter >= kJitterEnds_us[bin]) ++bin;
    ++jitter_[bin];
  }

  std::uint32_t passes() const { return passes_; }
  Time longest() const { return longest_; }
  std::uint32_t over_budget() const { return over_budget_; }
  const std::array<std::uint32_t, kJitterBins>& jitter() const { return jitter_; }
  /// At most two passes of the last second took longer than the budget.
  bool in_time(Time now) const { return !slow_.three_within_a_second(now); }

 private:
  /// The moments of the last three slow passes.
  class Slow {
   public:
    void add(Time now) {
      oldest_ = middle_;
      middle_ = newest_;
      newest_ = now;
      count_ = std::min(count_ + 1, 3);
    }
    bool three_within_a_second(Time now) const {
      return count_ == 3 && now - oldest_ <= hal::milliseconds(1000);
    }

   private:
    Time oldest_{}, middle_{}, newest_{};
    int count_{0};
  };

  std::uint32_t passes_{0};
  std::uint32_t over_budget_{0};
  Time longest_{};
  Time delay_{};
  Slow slow_;
  std::array<std::uint32_t, kJitterBins> jitter_{};
};

}  // namespace rosflight::core
