// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

namespace rosflight::autonomy {

/// Measures gaps in which a vehicle could not be guided: its state was lost, or its link was silent. What a
/// flight does when one has ended, for multirotor and fixed wing alike:
///
///     up to kGoesOn_s    goes on with the mission
///     longer             holds for kHold_s, returns to the start and lands
///
/// A mission runner gives a flight up when the link has been silent for kGivesUp_s. docs/faults.md has the
/// whole table. No clock.
class GapWatch {
 public:
  static constexpr double kSilent_s = 0.5;  ///< A link that is silent for longer is a gap.
  static constexpr double kGoesOn_s = 10.0;
  static constexpr double kHold_s = 8.0;
  static constexpr double kGivesUp_s = 60.0;

  /// Whether commands can be expected to arrive. @param silent_s  Status::silent_s.
  static bool linked(double silent_s) { return silent_s <= kSilent_s; }

  /// The first step of a flight, at t_s [s].
  void start(double t_s) {
    good_s_ = silent_at_s_ = t_s;
    silent_s_ = 0.0;
  }

  /// Once a step, at a time that grows.
  /// @param good  the vehicle can be guided in this step.
  /// @returns the time since it could be before [s], if it can be now: one period in flight. 0 in a gap.
  double step(double t_s, bool good, double silent_s) {
    if (!good) {
      silent_s_ = std::max(silent_s_, silent_s);
      if (!linked(silent_s)) silent_at_s_ = t_s;
      return 0.0;
    }
    const double gap_s = std::max(t_s - good_s_, silent_s_);
    start(t_s);
    return gap_s;
  }

  /// Time for which the vehicle could not be guided [s].
  double lasts_s(double t_s) const { return t_s - good_s_; }
  /// Time for which the link has been there and the state not [s]. Where a link comes back the state takes a moment.
  double linked_s(double t_s) const { return t_s - silent_at_s_; }

 private:
  double good_s_{};
  double silent_at_s_{};  ///< Last time with a silent link, or before the gap.
  double silent_s_{};     ///< Longest silence of the link in this gap.
};

}  // namespace rosflight::autonomy
