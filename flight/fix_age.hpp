// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>

namespace rosflight::flight {

/// Finds satellite fixes that a receiver sends late, by the receiver's own clock.
///
///     offset = stamp - UTC of the fix,   late = offset - the smallest offset                 (1)
///
/// The stamp is the companion's time of arrival or of the flight controller's; the two clocks differ by a
/// constant and a drift, which the smallest offset follows at kDrift. A fix that is late by more than
/// kTolerated_s was taken so much earlier. A receiver that sends no UTC has no ages.
class FixAge {
 public:
  static constexpr double kTolerated_s = 0.1;
  static constexpr double kDrift = 1e-4;

  /// Companion time at which the fix was taken [s].
  double time_of_fix(double stamp_s, double unix_s) {
    if (!(unix_s > 0.0)) return stamp_s;
    const double offset_s = stamp_s - unix_s;
    if (!smallest_s_) {
      smallest_s_ = offset_s;
      stamp_s_ = stamp_s;
    }
    const double drifted_s = *smallest_s_ + kDrift * std::max(stamp_s - stamp_s_, 0.0);
    smallest_s_ = std::min(offset_s, drifted_s);
    stamp_s_ = stamp_s;
    const double late_s = offset_s - *smallest_s_;
    return late_s > kTolerated_s ? stamp_s - late_s : stamp_s;
  }

 private:
  std::optional<double> smallest_s_;
  double stamp_s_{};  ///< Stamp of the newest fix.
};

}  // namespace rosflight::flight
