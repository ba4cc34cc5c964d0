// SPDX-License-Identifier: BSD-3-Clause
#include "sim/noise.hpp"

#include <string>

namespace rosflight::sim {
namespace {
double white_sigma(const ErrorParameters& p, Time period) {
  const double variance = p.noise_density * p.noise_density / to_seconds(period);
  return std::sqrt(variance + p.noise_sigma * p.noise_sigma);
}
}  // namespace

ErrorModel::ErrorModel(const ErrorParameters& p, Time period, const RandomSource& source,
                       std::string_view name)
    : constant_{p.fixed_bias +
                turn_on_bias(p.turn_on_bias, source.stream(std::string(name) + "/turn_on"))},
      white_{WhiteNoise::per_sample(white_sigma(p, period),
                                    source.stream(std::string(name) + "/white"))},
      walk_{p.bias_walk, period, source.stream(std::string(name) + "/walk")},
      drift_{p.drift_sigma, p.drift_time_s, period, source.stream(std::string(name) + "/drift")},
      quantiser_{p.resolution, p.limit} {}

}  // namespace rosflight::sim
