// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/environment/environment.hpp"
#include "sim/modules.hpp"
#include "sim/sensors/battery_monitor.hpp"
#include "sim/sensors/gnss.hpp"
#include "sim/sensors/imu.hpp"
#include "sim/sensors/magnetometer.hpp"
#include "sim/sensors/pressure.hpp"
#include "sim/sensors/rangefinder.hpp"

namespace rosflight::sim::sensors {

struct SensorsConfig {
  Imu::Config imu;
  Magnetometer::Config mag;
  Barometer::Config baro;
  PitotTube::Config diff_pressure;
  Rangefinder::Config range;
  Gnss::Config gnss;
  BatteryMonitor::Config battery;
};

/// The instruments of a ROSflight vehicle. Each has its own clock, delay and random streams:
/// switching one off, or changing its rate, leaves the readings of all others as they were, bit for
/// bit. Reads Truth, writes SensorSamples, every `has_` flag at every step. Allocates at
/// construction only.
class StandardSensors : public SensorsModule {
 public:
  /// @param environment  gives the place and the time of day of the satellites, and the magnetic
  /// field,
  ///                     which is the same everywhere in a flight.
  StandardSensors(const SensorsConfig& config, const EnvironmentParameters& environment,
                  const RandomSource& source);
  void step(const Truth& truth, SensorSamples& samples) override;

  /// Biases of the last IMU sample, for logs and for judging estimators.
  Vector3 gyro_bias() const { return imu_.instrument().gyro_bias(); }
  Vector3 accel_bias() const { return imu_.instrument().accel_bias(); }
  /// Slow error of the last satellite fix [m].
  Vector3 gnss_bias() const { return gnss_.instrument().bias(); }

 private:
  Scheduled<Imu> imu_;
  Scheduled<Magnetometer> mag_;
  Scheduled<Barometer> baro_;
  Scheduled<PitotTube> diff_pressure_;
  Scheduled<Rangefinder> range_;
  Scheduled<Gnss> gnss_;
  Scheduled<BatteryMonitor> battery_;
};

}  // namespace rosflight::sim::sensors
