// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/exposure.hpp"

#include <cmath>

namespace rosflight::sim::sensors {
namespace {

void sample_each(Timing& timing, Time period) {
  timing.period = period;
  timing.phase = timing.delay = Time{0};
}

/// The density of all white noise of samples `period` apart.
void use_density(ErrorParameters& errors, Time period) {
  const double T_s = to_seconds(period);
  errors.noise_density = std::sqrt(errors.noise_density * errors.noise_density +
                                   errors.noise_sigma * errors.noise_sigma * T_s);
  errors.noise_sigma = 0.0;
}

}  // namespace

SensorsConfig exposure(SensorsConfig config, Time imu_period, Time period) {
  Imu::Config& imu = config.imu;
  for (ErrorParameters* const errors : {&imu.gyro_rad_s.axis, &imu.accel_m_s2.axis}) {
    use_density(*errors, imu.timing.period);
    errors->resolution = 0.0;
  }
  imu.shows_lines = true;
  sample_each(imu.timing, imu_period);
  for (Timing* const timing :
       {&config.mag.timing, &config.baro.timing, &config.diff_pressure.timing, &config.range.timing,
        &config.battery.timing}) {
    sample_each(*timing, period);
  }
  sample_each(config.gnss.timing, config.gnss.timing.period);
  config.mag.field_T.axis.resolution = 0.0;
  config.baro.pressure_Pa.resolution = config.diff_pressure.pressure_Pa.resolution = 0.0;
  return config;
}

}  // namespace rosflight::sim::sensors
