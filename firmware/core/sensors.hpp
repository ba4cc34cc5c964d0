// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/calibration.hpp"
#include "firmware/core/log.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

/// The newest corrected measurements, and which of them are new in this pass.
struct Measurements {
  bool new_imu{}, new_mag{}, new_baro{}, new_diff_pressure{}, new_range{}, new_gnss{},
      new_battery{};
  hal::ImuSample imu;
  hal::MagSample mag;
  hal::BaroSample baro;
  hal::DiffPressureSample diff_pressure;
  hal::RangeSample range;
  hal::GnssSample gnss;
  hal::BatterySample battery;  ///< Low-passed.
  float altitude_m{};          ///< Standard-atmosphere altitude of the raw pressure.
  float airspeed_m_s{};        ///< Indicated, signed.
  float density_kg_m3{kSeaLevelDensity_kg_m3};
};

/// Takes samples from the board and makes measurements of them: mounting, calibration, filters.
///
///     imu        v <- R(q_mount)^T v ,  a <- a - (temp_comp T + bias) ,  w <- w - bias
///     mag        m <- A (R(q_mount)^T m - bias)
///     pressure   p <- p - bias ,  airspeed = sign(p) sqrt(|p| / (0.5 rho_0))
///     battery    V <- (1 - alpha) V + alpha V_before, from the first sample on
///
/// Samples with a NaN, an infinity or an absurdly large number are dropped (an infinite range is
/// not: it says that nothing is in reach). Calibrations need the vehicle at rest, the
/// accelerometer's also level; a failed one leaves the biases that were in force.
class Sensors {
 public:
  struct Config {
    Vector3 imu_mounting_deg{Vector3::Zero()}, mag_mounting_deg{Vector3::Zero()};
    Vector3 acc_bias{Vector3::Zero()}, acc_temp_comp{Vector3::Zero()}, gyro_bias{Vector3::Zero()};
    Vector3 mag_bias{Vector3::Zero()};
    Matrix3 mag_soft_iron{Matrix3::Identity()};
    float diff_pressure_bias_Pa{0.0f};
    float battery_voltage_lpf{0.995f}, battery_current_lpf{0.995f};
  };

  /// What calibrations found out in one pass.
  struct CalibrationEvents {
    bool gyro_done{}, gyro_failed{};
    bool accel_settled{};  ///< Measured without motion, whatever came of it: the estimator starts
                           ///< anew.
    bool accel_done{};
  };

  void configure(const Config& config);

  /// Polls every sensor once, in a fixed order. Results of calibrations go into `parameters` and
  /// `log`.
  CalibrationEvents step(Time now, hal::Board& board, Parameters& parameters, Log& log);

  const Measurements& measurements() const { return now_; }

  void start_gyro_calibration() { gyro_calibration_.start(); }
  void start_accel_calibration() {
    gyro_calibration_.start();
    accel_calibration_.start();
  }
  void start_baro_calibration() { baro_calibration_.start(); }
  void start_airspeed_calibration() { airspeed_calibration_.start(); }
  /// No calibration may end in the air: one that is under way on arming is forgotten.
  void stop_calibrations() {
    gyro_calibration_.stop();
    accel_calibration_.stop();
    baro_calibration_.stop();
    airspeed_calibration_.stop();
  }
  bool calibrating_imu() const {
    return gyro_calibration_.running() || accel_calibration_.running();
  }

 private:
  bool take_imu(hal::Board& board, Parameters& parameters, Log& log, CalibrationEvents& events);
  void calibrate_accel(const Vector3& accel, float temperature_K, Parameters& parameters, Log& log,
                       CalibrationEvents& events);
  void calibrate_gyro(const Vector3& gyro, Parameters& parameters, Log& log,
                      CalibrationEvents& events);
  // Each returns false for a sample that is no measurement.
  bool take(const hal::MagSample& raw);
  bool take(Time now, const hal::BaroSample& raw, Parameters& parameters, Log& log);
  bool take(Time now, const hal::DiffPressureSample& raw, Parameters& parameters, Log& log);
  bool take(const hal::RangeSample& raw);
  bool take(const hal::BatterySample& raw);

  Config config_{};
  Matrix3 imu_mounting_{Matrix3::Identity()};
  Matrix3 mag_mounting_{Matrix3::Identity()};
  bool imu_rotated_{false};
  Measurements now_{};
  ImuCalibration gyro_calibration_;
  ImuCalibration accel_calibration_;
  PressureCalibration baro_calibration_{25.0f};
  PressureCalibration airspeed_calibration_{100.0f};
  bool battery_seen_{false};
};

}  // namespace rosflight::core
