// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>

namespace rosflight_common {

/// Selects from a stream of stamps those that are due at a rate: 390 a second of 400, and all of 400 with jitter. Compiles as
/// C++17.
class Due {
 public:
  Due() = default;
  /// @param rate_Hz  above 0.
  explicit Due(double rate_Hz) { set_rate(rate_Hz); }

  void set_rate(double rate_Hz) { period_ns_ = static_cast<std::int64_t>(1e9 / rate_Hz); }

  /// Whether this stamp is due: at the rate on average, never sooner than 0.9 periods after the previous one. Starts again
  /// at a stamp that goes back and after a gap of more than a period.
  bool at(std::int64_t stamp_ns) {
    const std::int64_t early_ns = period_ns_ / 10;  // jitter must not drop it
    const bool goes_on = started_ && stamp_ns >= last_ns_;
    last_ns_ = stamp_ns;
    if (goes_on && (stamp_ns + early_ns < next_ns_ || stamp_ns + early_ns < due_ns_ + period_ns_))
      return false;
    const bool in_step = goes_on && stamp_ns < next_ns_ + period_ns_;
    next_ns_ = (in_step ? next_ns_ : stamp_ns) + period_ns_;
    due_ns_ = stamp_ns;
    started_ = true;
    return true;
  }

 private:
  std::int64_t period_ns_{1};
  std::int64_t next_ns_{0};
  std::int64_t last_ns_{0};
  std::int64_t due_ns_{0};  ///< The last one that was.
  bool started_{false};
};

/// Seconds from one stamp to the next; 0 for the first one and for those that repeat or go back. Compiles as C++17.
class StampSteps {
 public:
  double step_s(std::int64_t stamp_ns) {
    const std::int64_t step_ns = started_ ? stamp_ns - last_ns_ : 0;
    started_ = true;
    last_ns_ = stamp_ns;
    return step_ns > 0 ? static_cast<double>(step_ns) * 1e-9 : 0.0;
  }

 private:
  std::int64_t last_ns_{0};
  bool started_{false};
};

}  // namespace rosflight_common
