// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight::sim::sensors {

StandardSensors::StandardSensors(const SensorsConfig& c, const EnvironmentParameters& environment,
                                 const RandomSource& source)
    : imu_{c.imu.timing, Imu{c.imu, environment.gravity_m_s2, source}},
      mag_{c.mag.timing, Magnetometer{c.mag, environment.magnetic_field_W_T, source}},
      baro_{c.baro.timing, Barometer{c.baro, source}},
      diff_pressure_{c.diff_pressure.timing, PitotTube{c.diff_pressure, source}},
      range_{c.range.timing, Rangefinder{c.range, source}},
      gnss_{c.gnss.timing, Gnss{c.gnss, environment.origin, environment.start_unix_s, source}},
      battery_{c.battery.timing, BatteryMonitor{c.battery, source}} {}

void StandardSensors::step(const Truth& truth, SensorSamples& samples) {
  samples.has_imu = imu_.step(truth, samples.imu);
  samples.has_mag = mag_.step(truth, samples.mag);
  samples.has_baro = baro_.step(truth, samples.baro);
  samples.has_diff_pressure = diff_pressure_.step(truth, samples.diff_pressure);
  samples.has_range = range_.step(truth, samples.range);
  samples.has_gnss = gnss_.step(truth, samples.gnss);
  samples.has_battery = battery_.step(truth, samples.battery);
}

}  // namespace rosflight::sim::sensors
