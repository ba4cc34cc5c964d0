// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/rangefinder.hpp"

#include <algorithm>
#include <limits>

#include "base/constants.hpp"

namespace rosflight::sim::sensors {
namespace {
using base::kRadPerDeg;
constexpr double kNoEcho = std::numeric_limits<double>::infinity();
}  // namespace

Rangefinder::Rangefinder(const Config& config, const RandomSource& source)
    : config_{config},
      min_cos_tilt_{portable::sin_cos(config.max_tilt_deg * kRadPerDeg).cos},
      errors_{config.range_m, config.timing.period, source, "sensors/range"} {}

bool Rangefinder::measure(const Truth& truth, Sample& sample) {
  const Vector3 down_B = truth.body.q_WB.conjugate() * Vector3::UnitZ();
  const double height_m = -truth.body.p_W.z() - down_B.dot(config_.position_m);
  double range_m = 0.0;
  if (config_.pinned) {
    // ROSflight 2.x adds noise only between the limits.
    const double noisy_m = errors_.apply(height_m);
    const bool inside = height_m >= config_.min_m && height_m <= config_.max_m;
    range_m = inside ? noisy_m : std::clamp(height_m, config_.min_m, config_.max_m);
  } else {
    const double cos_tilt = down_B.z();
    const double distance_m = cos_tilt >= min_cos_tilt_ ? height_m / cos_tilt : kNoEcho;
    range_m = errors_.apply(std::clamp(distance_m, config_.min_m, config_.max_m));
    if (!(distance_m <= config_.max_m)) return false;
  }
  sample = {.stamp = truth.time,
            .range_m = static_cast<float>(range_m),
            .min_m = static_cast<float>(config_.min_m),
            .max_m = static_cast<float>(config_.max_m),
            .kind = config_.kind};
  return true;
}

}  // namespace rosflight::sim::sensors
