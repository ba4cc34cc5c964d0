// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>
#include <limits>
#include <string>

#include "config/table_fwd.hpp"
#include "sim/noise.hpp"

namespace rosflight::sim {

/// Errors of a device with many beams; all zero: a perfect one.
struct BeamErrorParameters {
  double min_m{0.1};        ///< Nearest distance that is measured.
  double max_m{30.0};       ///< Farthest; > min_m.
  double turn_on_bias_m{};  ///< Half width of (1), one draw for all beams.
  double noise_sigma_m{};   ///< s_0 of (2).
  double noise_share{};     ///< k of (2): noise that grows with the distance.
  double resolution_m{};    ///< Step of the reading; 0: none.
  double dropout_share{};   ///< Probability that a beam gives no reading.
};

/// The rows of these parameters.
config::Table<BeamErrorParameters> beam_error_table();

/// A distance d > 0 becomes
///
///     y = Q( d + b + sqrt(s_0^2 + (k d)^2) N )                                                 (1)
///
/// with the turn-on bias b, an independent standard normal draw N and the quantiser Q of sim/noise.hpp (5). Then
/// -inf below min_m, +inf beyond max_m or without a surface, NaN with the probability of a drop-out: as REP 117
/// (ranges) and REP 118 (depths) have it. Noise and drop-outs draw from streams of their own.
class BeamErrors {
 public:
  /// @param name  prefix of the streams.
  BeamErrors(const BeamErrorParameters& p, const RandomSource& source, const std::string& name)
      : p_{p},
        bias_m_{turn_on_bias(p.turn_on_bias_m, source.stream(name + "/turn_on"))},
        white_{WhiteNoise::per_sample(p.noise_sigma_m, source.stream(name + "/white"))},
        dropouts_{source.stream(name + "/dropouts")},
        quantiser_{p.resolution_m, 0.0} {}

  /// What is reported of a true distance; infinity: nothing was hit.
  float apply(double true_m) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (p_.dropout_share > 0.0 && dropouts_.uniform() < p_.dropout_share)
      return std::numeric_limits<float>::quiet_NaN();
    if (true_m == kInfinity) return static_cast<float>(kInfinity);
    const double grown_m = p_.noise_share * true_m;
    const double sigma_m = grown_m == 0.0
                               ? white_.sigma()
                               : std::sqrt(white_.sigma() * white_.sigma() + grown_m * grown_m);
    const double y_m = quantiser_.apply(true_m + bias_m_ + white_.sample(sigma_m));
    if (y_m < p_.min_m) return static_cast<float>(-kInfinity);
    return static_cast<float>(y_m > p_.max_m ? kInfinity : y_m);
  }
  double bias_m() const { return bias_m_; }
  /// Beyond this nothing can be read, whatever the noise: six sigmas of it.
  double reach_m() const {
    constexpr double kSigmas = 6.0;
    const double sigma_m = p_.noise_sigma_m + p_.noise_share * p_.max_m;
    return p_.max_m + p_.turn_on_bias_m + p_.resolution_m + kSigmas * sigma_m;
  }

 private:
  BeamErrorParameters p_;
  double bias_m_;
  WhiteNoise white_;
  RandomStream dropouts_;
  Quantiser quantiser_;
};

}  // namespace rosflight::sim
