// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/sampling.hpp"

namespace rosflight::sim::sensors {

/// Absolute static pressure:
///
///     y = E( p + c 1/2 rho |v_a|^2 )                                                      (1)
///
/// v_a is the velocity relative to the air. The pressure inside a vehicle differs from that of the
/// air around it; the coefficient c (typically -0.3 to 0.3, 0 for a well-placed port) is the fraction
/// of the dynamic pressure that is measured.
class Barometer {
 public:
  using Sample = hal::BaroSample;

  struct Config {
    Timing timing;
    ErrorParameters pressure_Pa;
    double dynamic_pressure_share{};  ///< c of (1).
    Temperature temperature;
  };

  /// @param source  of the random errors.
  Barometer(const Config& config, const RandomSource& source);
  /// (1) with its errors.
  bool measure(const Truth& truth, Sample& sample);

 private:
  double dynamic_pressure_share_;
  Temperature temperature_;
  ErrorModel errors_;
};

/// Pitot tube along body x:  y = E( 1/2 rho u |u| ), u the x component of the velocity relative to
/// the air. Incompressible; air from behind gives a negative reading.
class PitotTube {
 public:
  using Sample = hal::DiffPressureSample;

  struct Config {
    Timing timing;
    ErrorParameters pressure_Pa;
    bool always_positive{false};  ///< As in ROSflight 2.x: 1/2 rho u^2.
    Temperature temperature;
  };

  /// @param source  of the random errors.
  PitotTube(const Config& config, const RandomSource& source);
  /// The differential pressure with its errors.
  bool measure(const Truth& truth, Sample& sample);

 private:
  bool always_positive_;
  Temperature temperature_;
  ErrorModel errors_;
};

}  // namespace rosflight::sim::sensors
