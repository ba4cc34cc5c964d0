// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// Detects touch-down and standstill of a fixed wing, and estimates its height above ground.
///
/// Height: the range r along body z, over level ground, less the range r0 of the vehicle that
/// stands; without a usable echo the altitude above a ground that the caller gives.
///
///     h = r cos(tilt) - r0                                                                  (1)
///
/// Touch-down: the vertical speed is near zero and h is small, for a time. A vehicle that comes
/// down is commanded to sink; on the ground the sink does not come. A gust that carries it above the
/// ground looks the same but for its height: where (1) gives more than 0.4 m, the time is 3 s. No
/// sensor of its own, no clock.
class GroundDetector {
 public:
  /// The vehicle stands now.
  /// @param range_m  what the range sensor reads, along body z from the centre of mass [m].
  void set_standing(std::optional<double> range_m) { standing_range_m_ = range_m.value_or(0.0); }

  double standing_range_m() const { return standing_range_m_; }

  /// Height of the centre of mass above where it is when it stands [m], by (1).
  /// @param range_m      echo [m]; ignored if not finite, negative, above max_range_m or taken at a
  ///                     tilt of more than 37 degrees.
  /// @param ground_up_m  altitude of the standing vehicle above the origin [m], used without echo.
  double height_m(const StateEstimate& state, std::optional<double> range_m, double max_range_m,
                  double ground_up_m);

  /// Whether the vehicle rolls on the ground. Called once a step.
  /// @param descending  the phase leads to the ground: else it is never on it.
  /// @param flaring     near the ground by plan: a shorter time is enough (0.4 s, else 1.2 s).
  bool on_ground(const StateEstimate& state, double height_m, bool descending, bool flaring,
                 double dt_s);

  /// Whether the ground speed has been below 1 m/s for more than 1 s. Called once a step.
  bool stands(const StateEstimate& state, double dt_s);

 private:
  double standing_range_m_{};
  bool measured_{false};  ///< The last height is that of (1).
  double level_s_{};      ///< Without vertical speed, low.
  double still_s_{};
};

}  // namespace rosflight::autonomy::fixedwing
