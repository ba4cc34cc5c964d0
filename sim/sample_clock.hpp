// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/hal/time.hpp"

namespace rosflight::sim {

using hal::Time;

/// When something that works at a rate of its own has its turns.
struct Timing {
  bool enabled{true};
  Time period{};  ///< > 0.
  Time phase{};   ///< Time of the first sample, >= 0.
  Time delay{};   ///< From measurement to delivery, >= 0.
};

/// Turn k is due at phase + k period, in whole microseconds, so nothing drifts. It is taken in the
/// first step at or after that moment. A world that steps more slowly than that loses turns instead
/// of piling them up.
class SampleClock {
 public:
  /// @param timing  period and phase.
  explicit SampleClock(const Timing& timing)
      : next_{timing.enabled ? timing.phase : Time::max()}, period_{timing.period} {}

  /// Whether a sample is due at `now`; at most one per call.
  bool due(Time now) {
    if (now < next_) return false;
    next_ += period_;
    if (next_ <= now) next_ += ((now - next_) / period_ + 1) * period_;
    return true;
  }

 private:
  Time next_;
  Time period_;
};

}  // namespace rosflight::sim
