// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/presets.hpp"

#include <cmath>

#include "base/constants.hpp"

namespace rosflight::sim::sensors {
namespace {
using base::kRadPerDeg;
constexpr double kMilliG_m_s2 = base::kStandardGravity_m_s2 * 1e-3;
constexpr double kMilliGauss = 1e-7;  // [T]

Timing every(std::int64_t period_us, std::int64_t phase_us = 0, std::int64_t delay_us = 0) {
  return {
      .enabled = true, .period = Time{period_us}, .phase = Time{phase_us}, .delay = Time{delay_us}};
}

/// Rates of ROSflight's H7 boards where they state one, else of their simulator. Phases keep two
/// slow sensors out of the same 400 Hz step; all are multiples of it.
SensorsConfig rates() {
  SensorsConfig c;
  c.imu.timing = every(2'500);
  c.mag.timing = every(10'000, 2'500);
  c.baro.timing = every(20'000, 5'000);
  c.diff_pressure.timing = every(10'000, 7'500);
  c.range.timing = every(50'000, 10'000);
  c.gnss.timing = every(100'000, 20'000);
  c.battery.timing = every(100'000, 50'000);
  return c;
}

/// What is not an error but belongs to the instrument.
void describe_instruments(SensorsConfig& c) {
  // MaxBotix MB1242: 20 to 765 cm; echoes off level ground are lost beyond a tilt of some 30
  // degrees.
  c.range.min_m = 0.20;
  c.range.max_m = 7.65;
  c.range.max_tilt_deg = 30.0;
  c.range.kind = hal::RangeKind::kSonar;
  c.gnss.satellites = 15;
}

void current_imu(SensorsConfig& c) {
  // Bosch BMI088, data sheet. Gyroscope: 0.014 deg/s/sqrt(Hz), offset +-1 deg/s, 16 bits over
  // +-2000 deg/s, 0.015 deg/s/K, bias stability 2 deg/h. Accelerometer: 175 ug/sqrt(Hz), offset
  // +-20 mg, 16 bits over +-24 g, 0.2 mg/K. The correlation times and the accelerometer's drift are
  // those usual in Allan plots of such parts; the data sheet has none.
  auto& gyro = c.imu.gyro_rad_s.axis;
  gyro.noise_density = 0.014 * kRadPerDeg;
  gyro.turn_on_bias = 1.0 * kRadPerDeg;
  gyro.drift_sigma = 2.0 / 3600.0 * kRadPerDeg;
  gyro.drift_time_s = 300.0;
  gyro.resolution = 2000.0 / 32768.0 * kRadPerDeg;
  gyro.limit = 2000.0 * kRadPerDeg;
  auto& accel = c.imu.accel_m_s2.axis;
  accel.noise_density = 0.175 * kMilliG_m_s2;
  accel.turn_on_bias = 20.0 * kMilliG_m_s2;
  accel.drift_sigma = 0.05 * kMilliG_m_s2;
  accel.drift_time_s = 300.0;
  accel.resolution = 24'000.0 / 32768.0 * kMilliG_m_s2;
  accel.limit = 24'000.0 * kMilliG_m_s2;
  c.imu.gyro_temperature_rad_s_K = Vector3::Constant(0.015 * kRadPerDeg);
  c.imu.accel_temperature_m_s2_K = Vector3::Constant(0.2 * kMilliG_m_s2);
  c.imu.temperature.rise_K = 10.0;
  // 0.2 m/s^2 at the hover speed of the default vehicle (388 rad/s), the noise the ROSflight 2.x
  // simulator has when armed.
  c.imu.accel_vibration_m_s_rad = 0.2 / 388.0;
}

void current_magnetometer_and_pressures(SensorsConfig& c) {
  // ST IIS2MDC, data sheet: 3 mG rms in high resolution, 1.5 mG per bit, +-50 G. The hard
  // iron that a calibration leaves is taken as +-10 mG.
  auto& mag = c.mag.field_T.axis;
  mag.noise_sigma = 3.0 * kMilliGauss;
  mag.turn_on_bias = 10.0 * kMilliGauss;
  mag.resolution = 1.5 * kMilliGauss;
  mag.limit = 50'000.0 * kMilliGauss;
  c.mag.temperature.rise_K = 5.0;

  // Infineon DPS310, data sheet: precision 0.5 Pa (low power mode), absolute accuracy +-100 Pa.
  // Weather moves the pressure some 100 Pa a day: 0.3 Pa/sqrt(s).
  auto& baro = c.baro.pressure_Pa;
  baro.noise_sigma = 0.5;
  baro.turn_on_bias = 100.0;
  baro.bias_walk = 0.3;
  baro.resolution = 0.0625;
  c.baro.temperature.rise_K = 5.0;

  // TE MS4525DO, data sheet: +-1 psi (6895 Pa) over 80 % of 14 bits, accuracy 0.25 % of the span.
  // Noise of about one bit and the slow drift that is left after the firmware's calibration are
  // usual figures.
  auto& pitot = c.diff_pressure.pressure_Pa;
  pitot.noise_sigma = 1.0;
  pitot.turn_on_bias = 0.0025 * 2.0 * 6895.0;
  pitot.drift_sigma = 0.3;
  pitot.drift_time_s = 100.0;
  pitot.resolution = 2.0 * 6895.0 / (0.8 * 16384.0);
  pitot.limit = 6895.0;
  c.diff_pressure.temperature.rise_K = 5.0;
}

void current_range_gnss_battery(SensorsConfig& c) {
  // MaxBotix MB1242: resolution 1 cm; sound and processing take some 20 ms.
  c.range.range_m.noise_sigma = 0.01;
  c.range.range_m.resolution = 0.01;
  c.range.timing.delay = Time{20'000};

  // u-blox NEO-M9N, data sheet: 2.0 m circular error probable (radius of half the errors, 1.1774
  // sigma), 0.05 m/s. Height 1.5 times as bad, as usual. Correlation time 1100 s as in Beard &
  // McLain's table of GPS errors. UBX-NAV-PVT counts centimetres and millimetres. Delivery 22 ms
  // after validity: what ROSflight's H7 boards assume.
  constexpr double kHorizontal_m = 2.0 / 1.1774;
  c.gnss.timing.delay = Time{22'000};
  c.gnss.horizontal_m = {.noise_sigma = 0.02,
                         .drift_sigma = kHorizontal_m,
                         .drift_time_s = 1100.0,
                         .resolution = 0.01};
  c.gnss.vertical_m = {.noise_sigma = 0.04,
                       .drift_sigma = 1.5 * kHorizontal_m,
                       .drift_time_s = 1100.0,
                       .resolution = 0.001};
  c.gnss.velocity_m_s.axis = {.noise_sigma = 0.05, .resolution = 0.001};
  c.gnss.horizontal_accuracy_m = kHorizontal_m;
  c.gnss.vertical_accuracy_m = 1.5 * kHorizontal_m;
  c.gnss.speed_accuracy_m_s = 0.05;

  // A 12-bit converter behind a divider for 6 cells (33 V full scale) and a 150 A shunt.
  c.battery.voltage_V = {.noise_sigma = 0.01, .resolution = 33.0 / 4096.0, .limit = 33.0};
  c.battery.current_A = {.noise_sigma = 0.1, .resolution = 150.0 / 4096.0, .limit = 150.0};
}

/// Gauss-Markov error that ROSflight 2.x writes as  x <- exp(-k T) x + T sigma N.
void reference_markov(ErrorParameters& p, double sigma, double decay_1_s, Time period) {
  const double period_s = to_seconds(period);
  p.drift_time_s = 1.0 / decay_1_s;
  p.drift_sigma = period_s * sigma / std::sqrt(1.0 - portable::exp(-2.0 * decay_1_s * period_s));
}

/// Random walk that ROSflight 2.x writes as a step per sample.
void reference_walk(ErrorParameters& p, double step, Time period) {
  p.bias_walk = step / std::sqrt(to_seconds(period));
}
}  // namespace

SensorsConfig ideal() {
  SensorsConfig c = rates();
  describe_instruments(c);
  return c;
}

SensorsConfig current_hardware() {
  SensorsConfig c = ideal();
  current_imu(c);
  current_magnetometer_and_pressures(c);
  current_range_gnss_battery(c);
  return c;
}

SensorsConfig reference() {
  SensorsConfig c = rates();
  constexpr double kCabin_K = 300.15;
  c.mag.timing = every(20'000);
  c.baro.timing = every(10'000);
  c.diff_pressure.timing = every(10'000);
  c.range.timing = every(50'000);
  c.gnss.timing = every(100'000);
  c.battery.timing = every(5'000);

  auto& gyro = c.imu.gyro_rad_s.axis;
  gyro.turn_on_bias = 0.25;
  gyro.noise_sigma = 0.00226;
  reference_markov(gyro, 0.033, 20.0, c.imu.timing.period);
  c.imu.gyro_transient_rad_s = {0.003, -0.002, 0.001};
  c.imu.gyro_transient_time_s = 400.0;
  auto& accel = c.imu.accel_m_s2.axis;
  accel.turn_on_bias = 0.6;
  accel.noise_sigma = 0.2;
  reference_walk(accel, 1e-5, c.imu.timing.period);
  c.imu.standstill_speed_m_s = 0.05;
  c.imu.quiet_without_rotors = true;
  c.imu.temperature.fixed_K = kCabin_K;

  reference_markov(c.mag.field_T.axis, 3e-6, 7.0, c.mag.timing.period);
  c.mag.temperature.fixed_K = kCabin_K;

  c.baro.pressure_Pa.turn_on_bias = 500.0;
  c.baro.pressure_Pa.noise_sigma = 4.0;
  reference_walk(c.baro.pressure_Pa, 0.1, c.baro.timing.period);
  c.baro.temperature.fixed_K = kCabin_K;

  c.diff_pressure.pressure_Pa.turn_on_bias = 0.15;
  c.diff_pressure.pressure_Pa.noise_sigma = 1.15;
  reference_walk(c.diff_pressure.pressure_Pa, 0.001, c.diff_pressure.timing.period);
  c.diff_pressure.always_positive = true;
  c.diff_pressure.temperature.fixed_K = kCabin_K;

  c.range.min_m = 0.25;
  c.range.max_m = 8.0;
  c.range.max_tilt_deg = 89.0;
  c.range.pinned = true;
  c.range.range_m.noise_sigma = 0.03;

  reference_markov(c.gnss.horizontal_m, 0.21, 1.0 / 1100.0, c.gnss.timing.period);
  reference_markov(c.gnss.vertical_m, 0.4, 1.0 / 1100.0, c.gnss.timing.period);
  c.gnss.velocity_m_s.axis.noise_sigma = 0.01;
  c.gnss.horizontal_accuracy_m = 0.21;
  c.gnss.vertical_accuracy_m = 0.4;
  c.gnss.speed_accuracy_m_s = 0.01;
  c.gnss.satellites = 15;

  c.battery.fixed_voltage_V = 23.0;
  c.battery.fixed_current_A = 1.0;
  c.battery.voltage_V.noise_sigma = 0.3;
  return c;
}

}  // namespace rosflight::sim::sensors
