// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "sim/types.hpp"

namespace rosflight::flight::gazebo {

/// Wrenches with stamps as steps of a simulator whose steps are all equal.
///
/// A wrench stands for the time from the stamp before to its own, as in the dynamics node of ROSflight. With D the time
/// that the simulator is behind, in steps,
///
///     D += (stamp - stamp before)/step        a wrench arrives             (1)
///     D -= 1                                  the simulator has moved      (2)
///
/// a step is due while D >= 1/2. So stamps of a wall clock that jitter by less than half a step give one step each, and
/// none is lost in the long run. The first wrench, and stamps that stand or go back, stand for no time. D is bounded: a
/// simulator that cannot follow loses time and is never further behind than max_gap.
class WrenchSteps {
 public:
  /// @param max_gap  maximum time that one wrench stands for, and that the simulator is behind.
  explicit WrenchSteps(std::chrono::nanoseconds max_gap) : max_gap_{max_gap} {}

  /// @returns the time between the stamps.
  std::chrono::nanoseconds add(std::chrono::nanoseconds stamp, const sim::Wrench& wrench) {
    const std::chrono::nanoseconds gap = stamp_ ? stamp - *stamp_ : std::chrono::nanoseconds{0};
    stamp_ = stamp;
    wrench_ = wrench;
    if (gap.count() > 0) behind_ = std::min(behind_ + std::min(gap, max_gap_), max_gap_);
    return gap;
  }
  /// Its time does not count: the simulator stood.
  void skip(std::chrono::nanoseconds stamp) { stamp_ = stamp; }

  bool due(std::chrono::nanoseconds step) const { return stamp_ && 2 * behind_ >= step; }
  /// Behind as far as it can be, less one step: it loses time.
  bool loses_time(std::chrono::nanoseconds step) const { return behind_ >= max_gap_ - step; }
  /// (2). Also for a step that was not due: the world is then ahead, and the next wrench moves it less.
  const sim::Wrench& move(std::chrono::nanoseconds step) {
    behind_ -= step;
    return wrench_;
  }

  /// The world is put elsewhere: what it was ahead does not count, so the next wrench moves it.
  void forget_lead() {
    if (behind_.count() < 0) behind_ = std::chrono::nanoseconds{0};
  }

  /// Stamp of the last wrench; empty: there was none.
  const std::optional<std::chrono::nanoseconds>& stamp() const { return stamp_; }

 private:
  std::chrono::nanoseconds max_gap_;
  std::optional<std::chrono::nanoseconds> stamp_;
  sim::Wrench wrench_;
  std::chrono::nanoseconds behind_{0};
};

}  // namespace rosflight::flight::gazebo
