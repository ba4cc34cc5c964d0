// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/sensors.hpp"

#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kLargestGyroBias_rad_s = 1.0f;
constexpr float kLargestAccelSpread_m_s2 = 1.0f;
constexpr float kLargestAccelBias_m_s2 = 3.0f;

/// False for NaN, infinity and what no sensor of any kind measures in SI units: sums and squares of
/// what passes are finite too.
bool plausible(const hal::Vec3& v) {
  constexpr float kAbsurd = 1e6f;
  return std::abs(v[0]) < kAbsurd && std::abs(v[1]) < kAbsurd && std::abs(v[2]) < kAbsurd;
}

bool plausible(const hal::GnssSample& s) {
  return std::isfinite(s.latitude_deg) && std::isfinite(s.longitude_deg) &&
         std::isfinite(s.height_msl_m) && plausible(s.velocity_ned_m_s);
}

hal::Vec3 to_array(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// v <- R(q)^T v, q from Euler angles.
Matrix3 mounting(const Vector3& deg) {
  const Vector3 rad = deg * kRadPerDeg;
  return rotation_matrix(quaternion_from_euler(rad.x(), rad.y(), rad.z())).transpose();
}

/// Stores three biases that belong together. @returns false if one is out of its range; the others
/// are then untouched.
bool set_three(Parameters& parameters, Param first, const Vector3& v) {
  const auto base = static_cast<std::uint16_t>(first);
  for (std::uint16_t k = 0; k < 3; ++k) {
    if (!Parameters::in_range(static_cast<Param>(base + k), ParamValue{v[k]})) return false;
  }
  for (std::uint16_t k = 0; k < 3; ++k) {
    static_cast<void>(parameters.set_float(static_cast<Param>(base + k), v[k]));
  }
  return true;
}

}  // namespace

void Sensors::configure(const Config& config) {
  config_ = config;
  imu_mounting_ = mounting(config.imu_mounting_deg);
  mag_mounting_ = mounting(config.mag_mounting_deg);
  imu_rotated_ = !config.imu_mounting_deg.isZero(0.0f);
}

Sensors::CalibrationEvents Sensors::step(Time now, hal::Board& board, Parameters& parameters,
                                         Log& log) {
  CalibrationEvents events;
  now_.new_imu = take_imu(board, parameters, log, events);
  now_.new_gnss = board.gnss.poll(now_.gnss) && plausible(now_.gnss);
  hal::BaroSample baro;
  now_.new_baro = board.baro.poll(baro) && take(now, baro, parameters, log);
  hal::MagSample mag;
  now_.new_mag = board.mag.poll(mag) && take(mag);
  hal::DiffPressureSample pressure;
  now_.new_diff_pressure =
      board.diff_pressure.poll(pressure) && take(now, pressure, parameters, log);
  hal::RangeSample range;
  now_.new_range = board.range.poll(range) && take(range);
  hal::BatterySample battery;
  now_.new_battery = board.battery.poll(battery) && take(battery);
  return events;
}

bool Sensors::take_imu(hal::Board& board, Parameters& parameters, Log& log,
                       CalibrationEvents& events) {
  hal::ImuSample raw;
  if (!board.imu.poll(raw)) return false;
  if (!plausible(raw.accel_m_s2) || !plausible(raw.gyro_rad_s) ||
      !std::isfinite(raw.temperature_K)) {
    return false;
  }
  Vector3 accel = to_vector(raw.accel_m_s2);
  Vector3 gyro = to_vector(raw.gyro_rad_s);
  if (imu_rotated_) {
    accel = imu_mounting_ * accel;
    gyro = imu_mounting_ * gyro;
  }
  if (accel_calibration_.running()) {
    calibrate_accel(accel, raw.temperature_K, parameters, log, events);
  }
  if (gyro_calibration_.running()) calibrate_gyro(gyro, parameters, log, events);
  // While a bias is being measured none is subtracted; if that fails the old one is still there.
  accel -= config_.acc_temp_comp * raw.temperature_K;
  if (!accel_calibration_.running()) accel -= config_.acc_bias;
  if (!gyro_calibration_.running()) gyro -= config_.gyro_bias;
  now_.imu = {raw.stamp, to_array(accel), to_array(gyro), raw.temperature_K};
  return true;
}

void Sensors::calibrate_accel(const Vector3& accel, float temperature_K, Parameters& parameters,
                              Log& log, CalibrationEvents& events) {
  const Vector3 level{0.0f, 0.0f, -kGravity_m_s2};
  if (!accel_calibration_.add(accel - level - config_.acc_temp_comp * temperature_K)) return;
  if (accel_calibration_.spread().norm() > kLargestAccelSpread_m_s2) {
    log.error("Too much movement for IMU cal");
    return;
  }
  events.accel_settled = true;
  const Vector3 bias = accel_calibration_.mean();
  if (bias.norm() >= kLargestAccelBias_m_s2 || !set_three(parameters, Param::kAccXBias, bias)) {
    log.error(Text("Large accelerometer bias: norm ").add(bias.norm(), 2));
    return;
  }
  config_.acc_bias = bias;
  events.accel_done = true;
  log.info("IMU offsets captured");
}

void Sensors::calibrate_gyro(const Vector3& gyro, Parameters& parameters, Log& log,
                             CalibrationEvents& events) {
  if (!gyro_calibration_.add(gyro)) return;
  const Vector3 bias = gyro_calibration_.mean();
  if (bias.norm() >= kLargestGyroBias_rad_s || !set_three(parameters, Param::kGyroXBias, bias)) {
    events.gyro_failed = true;
    log.error("Gyro calibration failed: too much movement");
    return;
  }
  config_.gyro_bias = bias;
  events.gyro_done = true;
  log.info("Gyro calibration complete");
}

bool Sensors::take(const hal::MagSample& raw) {
  if (!plausible(raw.field_T)) return false;
  const Vector3 field =
      config_.mag_soft_iron * (mag_mounting_ * to_vector(raw.field_T) - config_.mag_bias);
  now_.mag = {raw.stamp, to_array(field), raw.temperature_K};
  return true;
}

bool Sensors::take(Time now, const hal::BaroSample& raw, Parameters& parameters, Log& log) {
  if (!std::isfinite(raw.pressure_Pa) || raw.pressure_Pa <= 0.0f) return false;
  if (baro_calibration_.running()) {
    const auto result = baro_calibration_.add(now, raw.pressure_Pa);
    if (result == PressureCalibration::Result::kGood) {
      const float mean = baro_calibration_.mean_Pa();
      const float level = pressure_altitude_m(mean);
      if (Parameters::in_range(Param::kBaroBias, ParamValue{mean}) &&
          Parameters::in_range(Param::kGroundLevel, ParamValue{level})) {
        static_cast<void>(parameters.set_float(Param::kBaroBias, mean));
        static_cast<void>(parameters.set_float(Param::kGroundLevel, level));
        log.info("Baro Cal successful!");
      } else {
        log.error("Barometer out of range, not taken");
      }
    } else if (result == PressureCalibration::Result::kUnsteady) {
      log.error("Too much movement for barometer cal");
    }
  }
  now_.baro = raw;
  now_.altitude_m = pressure_altitude_m(raw.pressure_Pa);
  now_.density_kg_m3 = air_density_kg_m3(raw.pressure_Pa);
  return true;
}

bool Sensors::take(Time now, const hal::DiffPressureSample& raw, Parameters& parameters, Log& log) {
  if (!std::isfinite(raw.pressure_Pa)) return false;
  if (airspeed_calibration_.running()) {
    const auto result = airspeed_calibration_.add(now, raw.pressure_Pa);
    if (result == PressureCalibration::Result::kGood) {
      const float mean = airspeed_calibration_.mean_Pa();
      if (parameters.set_float(Param::kDiffPressBias, mean) == SetResult::kOutOfRange) {
        log.error("Airspeed offset out of range, not taken");
      } else {
        config_.diff_pressure_bias_Pa = mean;
        log.info("Airspeed Cal Successful!");
      }
    } else if (result == PressureCalibration::Result::kUnsteady) {
      log.error("Too much movement for diff pressure cal");
    }
  }
  now_.diff_pressure = raw;
  now_.diff_pressure.pressure_Pa -= config_.diff_pressure_bias_Pa;
  const float p = now_.diff_pressure.pressure_Pa;
  now_.airspeed_m_s = std::copysign(std::sqrt(std::abs(p) / (0.5f * kSeaLevelDensity_kg_m3)), p);
  return true;
}

bool Sensors::take(const hal::RangeSample& raw) {
  if (std::isnan(raw.range_m)) return false;
  now_.range = raw;
  return true;
}

bool Sensors::take(const hal::BatterySample& raw) {
  if (!std::isfinite(raw.voltage_V) || !std::isfinite(raw.current_A)) return false;
  hal::BatterySample& filtered = now_.battery;
  if (!battery_seen_) {
    battery_seen_ = true;
    filtered = raw;
    return true;
  }
  filtered.stamp = raw.stamp;
  filtered.voltage_V += (1.0f - config_.battery_voltage_lpf) * (raw.voltage_V - filtered.voltage_V);
  filtered.current_A += (1.0f - config_.battery_current_lpf) * (raw.current_A - filtered.current_A);
  return true;
}

}  // namespace rosflight::core
