// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/magnetometer.hpp"

#include "sim/sensors/imu.hpp"

namespace rosflight::sim::sensors {

Magnetometer::Magnetometer(const Config& config, const Vector3& field_W_T,
                           const RandomSource& source)
    : distortion_{config.soft_iron * mounting_rotation(config.rotation_deg)},
      temperature_{config.temperature},
      field_W_T_{field_W_T},
      errors_{config.field_T, config.timing.period, source, "sensors/mag"} {}

bool Magnetometer::measure(const Truth& truth, Sample& sample) {
  const Vector3 field_B = truth.body.q_WB.conjugate() * field_W_T_;
  const Vector3 field_S = distortion_ * field_B;
  sample = {.stamp = truth.time,
            .field_T = to_floats(errors_.apply(field_S)),
            .temperature_K = static_cast<float>(temperature_.at(truth))};
  return true;
}

}  // namespace rosflight::sim::sensors
