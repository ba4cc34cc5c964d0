// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/pressure.hpp"

#include <cmath>

namespace rosflight::sim::sensors {
namespace {
Vector3 velocity_in_air(const Truth& truth) {
  return truth.body.v_B - truth.body.q_WB.conjugate() * truth.air.wind_W;
}
}  // namespace

Barometer::Barometer(const Config& config, const RandomSource& source)
    : dynamic_pressure_share_{config.dynamic_pressure_share},
      temperature_{config.temperature},
      errors_{config.pressure_Pa, config.timing.period, source, "sensors/baro"} {}

bool Barometer::measure(const Truth& truth, Sample& sample) {
  double pressure_Pa = truth.air.pressure_Pa;
  if (dynamic_pressure_share_ != 0.0) {
    pressure_Pa += dynamic_pressure_share_ * 0.5 * truth.air.density_kg_m3 *
                   velocity_in_air(truth).squaredNorm();
  }
  sample = {.stamp = truth.time,
            .pressure_Pa = static_cast<float>(errors_.apply(pressure_Pa)),
            .temperature_K = static_cast<float>(temperature_.at(truth))};
  return true;
}

PitotTube::PitotTube(const Config& config, const RandomSource& source)
    : always_positive_{config.always_positive},
      temperature_{config.temperature},
      errors_{config.pressure_Pa, config.timing.period, source, "sensors/diff_pressure"} {}

bool PitotTube::measure(const Truth& truth, Sample& sample) {
  const double u = velocity_in_air(truth).x();
  const double speed_squared = always_positive_ ? u * u : u * std::abs(u);
  const double pressure_Pa = 0.5 * truth.air.density_kg_m3 * speed_squared;
  sample = {.stamp = truth.time,
            .pressure_Pa = static_cast<float>(errors_.apply(pressure_Pa)),
            .temperature_K = static_cast<float>(temperature_.at(truth))};
  return true;
}

}  // namespace rosflight::sim::sensors
