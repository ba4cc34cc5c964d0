// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/environment/geodesy.hpp"
#include "sim/sensors/sampling.hpp"
#include "sim/sensors/vector_errors.hpp"

namespace rosflight::sim::sensors {

/// Satellite receiver with its antenna at r from the centre of mass:
///
///     p = p_W + R_WB r + e_p      e_p: error models of sim/noise.hpp, horizontal and vertical
///     v = R_WB (v_B + w x r) + e_v
///
/// The position error is mostly a slow Gauss-Markov process, as satellite clocks, orbits and the
/// ionosphere make it (R. Beard, T. McLain, Small Unmanned Aircraft, 2012, sec. 7.5). Heights are
/// above the surface on which the origin's height is measured: sea level, its distance to the
/// ellipsoid (some tens of metres) taken as constant over the flight.
///
/// Without a fix (at start, and in drop-outs that come at random, mean interval and mean duration
/// exponential) samples go on with fix kNone, no satellites, the last position and no accuracy.
class Gnss {
 public:
  using Sample = hal::GnssSample;
  static constexpr float kNoAccuracy = 9999.0F;

  struct Config {
    Timing timing;
    ErrorParameters horizontal_m;  ///< North and east each.
    ErrorParameters vertical_m;
    VectorErrorParameters velocity_m_s;
    double horizontal_accuracy_m{};  ///< As reported.
    double vertical_accuracy_m{};
    double speed_accuracy_m_s{};
    int satellites{};
    Vector3 position_m{Vector3::Zero()};  ///< r.
    double first_fix_s{};                 ///< Time from start to the first fix.
    double dropout_interval_s{};          ///< Mean time between drop-outs; 0: none.
    double dropout_duration_s{};          ///< Mean; > 0 where there are drop-outs.
  };

  /// @param start_unix_s  time of the satellites at time 0.
  Gnss(const Config& config, const Geodetic& origin, std::int64_t start_unix_s,
       const RandomSource& source);
  /// Position and velocity with their errors; without a fix the last position.
  bool measure(const Truth& truth, Sample& sample);
  /// The part of the last position's error that is not white noise.
  Vector3 bias() const { return {north_.bias(), east_.bias(), down_.bias()}; }

 private:
  bool has_fix(Time now);
  Time random_duration(double mean_s);

  Config config_;
  LocalFrame frame_;
  std::int64_t start_unix_s_;
  ErrorModel north_;
  ErrorModel east_;
  ErrorModel down_;
  VectorErrorModel velocity_;
  RandomStream dropouts_;
  bool fix_{false};
  Time change_{};  ///< Time of the next change of fix_.
  Geodetic last_;
};

}  // namespace rosflight::sim::sensors
