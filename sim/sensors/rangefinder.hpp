// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/sampling.hpp"

namespace rosflight::sim::sensors {

/// Distance to the ground plane z_W = 0 along body z:
///
///     d = h / cos(theta),  h the height of the sensor, theta the tilt of body z from vertical  (1)
///     y = E( max(d, min) )                                                     (2)
///
/// No sample at all beyond max_m or max_tilt_deg: there is no echo.
class Rangefinder {
 public:
  using Sample = hal::RangeSample;

  struct Config {
    Timing timing;
    ErrorParameters range_m;
    double min_m{};
    double max_m{};
    double max_tilt_deg{};  ///< Below 90.
    hal::RangeKind kind{hal::RangeKind::kSonar};
    Vector3 position_m{Vector3::Zero()};  ///< In body axes.
    bool pinned{false};  ///< As in ROSflight 2.x: height instead of (1), max_m beyond max_m.
  };

  /// @param source  of the random errors.
  Rangefinder(const Config& config, const RandomSource& source);
  /// (2). @returns false without an echo.
  bool measure(const Truth& truth, Sample& sample);

 private:
  Config config_;
  double min_cos_tilt_;
  ErrorModel errors_;
};

}  // namespace rosflight::sim::sensors
