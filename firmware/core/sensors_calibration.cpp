// SPDX-License-Identifier: BSD-3-Clause
// What a calibration accepts and stores; sensors.cpp has what every sample passes.
#include <algorithm>
#include <cmath>

#include "firmware/core/sensors.hpp"

namespace rosflight::core {
namespace {

// Offset of each axis at rest, of the parts that fly: +-20 deg/s of an MPU-6000 (data sheet,
// zero-rate output), +-0.25 rad/s in the simulator of ROSflight 2.x, +-1 deg/s of a BMI088.
constexpr float kMaxGyroBias_rad_s = 0.35f;
// Maximum less minimum of 1001 samples is some 6.5 sigma of white noise: 0.25 rad/s as the norm of
// three axes at 0.0226 rad/s (the noisiest simulated sensor), 0.05 rad/s for a BMI088. The rest is
// for wind and hands.
constexpr float kMaxGyroSpread_rad_s = 0.3f;
constexpr float kMaxAccelSpread_m_s2 = 1.0f;
constexpr float kMaxAccelBias_m_s2 = 3.0f;
constexpr float kMaxTilt_deg = 5.0f;

/// Angle between a mean accelerometer reading and that of a level vehicle, from its horizontal part
/// (which an offset along z does not change) up to 90 degrees.
float tilt_deg(const Vector3& accel) {
  const float horizontal = std::sqrt(accel.x() * accel.x() + accel.y() * accel.y());
  if (accel.z() > 0.0f) return atan2(horizontal, -accel.z()) / kRadPerDeg;
  return asin(std::min(horizontal / kGravity_m_s2, 1.0f)) / kRadPerDeg;
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

/// While a bias is measured none is subtracted; after a failure the old one is in force again.
[[gnu::cold, gnu::noinline]] void Sensors::calibrate(Vector3& accel, Vector3& gyro,
                                                     float temperature_K, Parameters& parameters,
                                                     Log& log, CalibrationEvents& events) {
  if (accel_calibration_.running()) {
    calibrate_accel(accel, temperature_K, parameters, log, events);
  }
  if (gyro_calibration_.running()) calibrate_gyro(gyro, accel, parameters, log, events);
  accel -= config_.acc_temp_comp * temperature_K;
  if (!accel_calibration_.running()) accel -= config_.acc_bias;
  if (!gyro_calibration_.running()) gyro -= config_.gyro_bias;
}

void Sensors::calibrate_accel(const Vector3& accel, float temperature_K, Parameters& parameters,
                              Log& log, CalibrationEvents& events) {
  const Vector3 level{0.0f, 0.0f, -kGravity_m_s2};
  if (!accel_calibration_.add(accel - level - config_.acc_temp_comp * temperature_K)) return;
  if (accel_calibration_.spread().norm() > kMaxAccelSpread_m_s2) {
    log.error("Too much movement for IMU cal");
    return;
  }
  const Vector3 bias = accel_calibration_.mean();
  const float tilt = tilt_deg(level + bias);
  if (tilt > kMaxTilt_deg) {
    log.error(Text("Accel calibration refused: tilt ").add(tilt, 1).add(" deg"));
    return;
  }
  events.accel_settled = true;
  if (bias.norm() >= kMaxAccelBias_m_s2 || !set_three(parameters, Param::kAccXBias, bias)) {
    log.error(Text("Large accelerometer bias: norm ").add(bias.norm(), 2));
    return;
  }
  config_.acc_bias = bias;
  events.accel_done = true;
  log.info("IMU offsets captured");
}

void Sensors::calibrate_gyro(const Vector3& gyro, const Vector3& accel, Parameters& parameters,
                             Log& log, CalibrationEvents& events) {
  gravity_while_gyro_.add(accel);
  if (!gyro_calibration_.add(gyro)) return;
  const Vector3 bias = gyro_calibration_.mean();
  const float moved = gyro_calibration_.spread().norm();
  const float swayed = gravity_while_gyro_.spread().norm();
  Text refused("Gyro calibration refused: ");
  if (moved > kMaxGyroSpread_rad_s) {
    refused.add("moved ").add(moved, 2).add(" rad/s");
  } else if (bias.cwiseAbs().maxCoeff() > kMaxGyroBias_rad_s) {
    refused.add("mean ").add(bias.norm(), 2).add(" rad/s");
  } else if (swayed > kMaxAccelSpread_m_s2) {  // a turn too slow for the spread of the gyro
    refused.add("swayed ").add(swayed, 2).add(" m/s^2");
  } else if (set_three(parameters, Param::kGyroXBias, bias)) {
    config_.gyro_bias = bias;
    events.gyro_done = true;
    log.info("Gyro calibration complete");
    return;
  }
  events.gyro_failed = true;
  log.error(refused);
}

void Sensors::calibrate_baro(Time now, float pressure_Pa, Parameters& parameters, Log& log) {
  const auto result = baro_calibration_.add(now, pressure_Pa);
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

void Sensors::calibrate_airspeed(Time now, float pressure_Pa, Parameters& parameters, Log& log) {
  const auto result = airspeed_calibration_.add(now, pressure_Pa);
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

}  // namespace rosflight::core
