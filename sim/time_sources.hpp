// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

#include "sim/modules.hpp"

namespace rosflight::sim {

/// As fast as the machine allows: every step has the same length and nobody waits.
class LockStepTime : public TimeSource {
 public:
  /// @throws std::invalid_argument  for a step that is not positive.
  explicit LockStepTime(Time step);
  Time advance(Time now) override { return now + step_; }

 private:
  Time step_;
};

/// The clock on the wall, kept outside so that tests bring their own and simulations cannot read
/// it.
class WallClock {
 public:
  virtual ~WallClock() = default;
  /// Time of the wall, from any origin.
  virtual Time now() = 0;
  /// Returns at that time, or at once if it has passed.
  virtual void sleep_until(Time wall) = 0;
};

/// The operating system's monotonic clock.
class SteadyWallClock : public WallClock {
 public:
  Time now() override;
  void sleep_until(Time wall) override;
};

/// Steps of the same length, paced so that simulated time runs at `factor` times wall time:
///
///     step ends at  wall_0 + (t - t_0) / factor                                          (1)
///
/// The steps are the same numbers as in lock-step; only their moments on the wall differ. A step
/// that comes up to `timeout` late is caught up at full speed; one that is later (debugger,
/// suspended computer) moves t_0 and wall_0 to now instead of racing, and counts as a slip.
class PacedTime : public TimeSource {
 public:
  static constexpr Time kMaxDelay = std::chrono::milliseconds(100);

  /// `wall` must outlive this. @throws std::invalid_argument  step or factor not positive or
  /// finite.
  PacedTime(Time step, double factor, WallClock& wall);
  Time advance(Time now) override;

  /// From the next step on. @throws std::invalid_argument  not positive or finite.
  void set_factor(double factor);
  double factor() const { return factor_; }
  /// Steps that came too late to be caught up.
  std::uint64_t slips() const { return slips_; }

 private:
  Time step_;
  double factor_;
  WallClock& wall_;
  bool anchored_{false};
  Time sim_anchor_{};
  Time wall_anchor_{};
  std::uint64_t slips_{0};
};

}  // namespace rosflight::sim
