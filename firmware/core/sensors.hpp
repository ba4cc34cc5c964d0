// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/calibration.hpp"
#include "firmware/core/gyro_chain.hpp"
#include "firmware/core/imu_clock.hpp"
#include "firmware/core/imu_mean.hpp"
#include "firmware/core/log.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/hal/roles.hpp"

namespace rosflight::core {

/// The newest corrected measurements, and which of them are new in this pass.
struct Measurements {
  bool new_imu{}, new_mag{}, new_baro{}, new_diff_pressure{}, new_range{}, new_gnss{},
      new_battery{};
  bool new_aid{};  ///< Some sensor besides the IMU.
  hal::ImuSample imu;
  hal::MagSample mag;
  hal::BaroSample baro;
  hal::DiffPressureSample diff_pressure;
  hal::RangeSample range;
  hal::GnssSample gnss;
  hal::BatterySample battery;  ///< Low-passed.
  float altitude_m{};          ///< Standard-atmosphere altitude of the raw pressure.
  float airspeed_m_s{};        ///< Indicated, signed.
  float density_kg_m3{kSeaLevelDensity_kg_m3};  ///< Low-passed.
};

/// Turns samples of the board into measurements: mounting, calibration, filters.
///
///     imu        v <- R(q_mount)^T v ,  a <- a - (temp_comp T + bias) ,  w <- w - bias
///                w filtered as sampled, before all this, if asked for (GyroChain); then the mean of
///                samples that come faster than 1250 Hz (ImuMean)
///     mag        m <- A (R(q_mount)^T m - bias)
///     pressure   p <- p - bias ,  airspeed = sign(p) sqrt(|p| / (0.5 rho_0))
///     density    rho <- rho + dt/(5 s + dt) (rho(p) - rho), from the first sample on
///     battery    V <- (1 - alpha) V + alpha V_before, from the first sample on
///
/// Samples with a NaN, an infinity or a number beyond the range of the sensor are rejected (an
/// infinite range is valid: nothing is within reach). So are IMU samples whose stamp is unusable
/// (ImuClock) and those that equal the nineteen before bit by bit: noise changes the last bits of
/// every real sensor. Rejected samples are counted and have no other effect.
///
/// Calibrations need the vehicle at rest, that of the accelerometer also level within 5 degrees; a
/// failed one leaves the biases unchanged. A gyro calibration is rejected if spread or mean exceed
/// those of a sensor at rest, and if gravity moves meanwhile (a slow turn about a horizontal axis).
/// A turn about the vertical slower than the largest offset (0.35 rad/s) cannot be distinguished
/// from an offset.
class Sensors {
 public:
  struct Config {
    Vector3 imu_mounting_deg{Vector3::Zero()}, mag_mounting_deg{Vector3::Zero()};
    Vector3 acc_bias{Vector3::Zero()}, acc_temp_comp{Vector3::Zero()}, gyro_bias{Vector3::Zero()};
    Vector3 mag_bias{Vector3::Zero()};
    Matrix3 mag_soft_iron{Matrix3::Identity()};
    float diff_pressure_bias_Pa{0.0f};
    float gyro_low_pass_Hz{0.0f}, gyro_notch_Hz{0.0f}, gyro_notch_width_Hz{30.0f};
    float battery_voltage_lpf{0.995f}, battery_current_lpf{0.995f};
  };

  /// Calibrations that ended in one pass.
  struct CalibrationEvents {
    bool gyro_done{}, gyro_failed{};
    bool accel_settled{};  ///< Measured level and without motion, with or without a result; the
                           ///< estimator is restarted.
    bool accel_done{};
    bool any() const { return gyro_done || gyro_failed || accel_settled || accel_done; }
  };

  /// Applies new settings; filters and calibrations go on.
  void configure(const Config& config);

  /// Polls the IMU, then the other sensors. A pass with an IMU sample takes at most one sample of
  /// them, so that the delay from gyro to motors stays short; a pass without takes one of each.
  /// Results of calibrations go to `parameters` and `log`.
  CalibrationEvents step(Time now, hal::Board& board, Parameters& parameters, Log& log);

  const Measurements& measurements() const { return now_; }
  /// Time step of the newest IMU sample; of an unusable one too, and since the last mean if it is one.
  const ImuClock::Step& imu_step() const { return imu_step_; }
  /// Samples that were not used, by cause (Reject), since power-up.
  const std::array<std::uint32_t, kRejects>& rejected() const { return rejected_; }
  /// Filters of the gyro at the IMU rate; off unless parameters ask for them.
  const GyroChain& gyro_chain() const { return gyro_chain_; }

  /// Starts a calibration; the vehicle must be at rest.
  void start_gyro_calibration() { start_gyro(); }
  /// Likewise, with the gyro's; the vehicle must also be level.
  void start_accel_calibration() {
    start_gyro();
    accel_calibration_.start();
  }
  /// Starts the calibration of the barometer at rest.
  void start_baro_calibration() { baro_calibration_.start(); }
  /// Starts the calibration of the differential pressure, without wind on the pitot tube.
  void start_airspeed_calibration() { airspeed_calibration_.start(); }
  /// Ends every calibration without a result; call on arming, so that none ends in the air.
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
  void poll_aids(Time now, hal::Board& board, Parameters& parameters, Log& log);
  bool poll_imu(Time now, hal::Board& board, Log& log);
  bool take_imu(Time now, hal::Board& board, Parameters& parameters, Log& log,
                CalibrationEvents& events);
  void filter_gyro(hal::ImuSample& raw, Log& log);
  void configure_gyro_chain(float rate_Hz, Log& log);
  bool usable(Time now, const hal::ImuSample& raw);
  bool stuck(const hal::ImuSample& raw);
  bool reject(Reject cause) {
    ++rejected_[static_cast<std::size_t>(cause)];
    return false;
  }
  void calibrate(Vector3& accel, Vector3& gyro, float temperature_K, Parameters& parameters,
                 Log& log, CalibrationEvents& events);
  [[gnu::cold]] void calibrate_accel(const Vector3& accel, float temperature_K,
                                     Parameters& parameters, Log& log, CalibrationEvents& events);
  [[gnu::cold]] void calibrate_gyro(const Vector3& gyro, const Vector3& accel,
                                    Parameters& parameters, Log& log, CalibrationEvents& events);
  [[gnu::cold]] void calibrate_baro(Time now, float pressure_Pa, Parameters& parameters, Log& log);
  [[gnu::cold]] void calibrate_airspeed(Time now, float pressure_Pa, Parameters& parameters,
                                        Log& log);
  void start_gyro() {
    gyro_calibration_.start();
    gravity_while_gyro_.start();
  }
  // Each returns false for a sample that is no measurement.
  bool take(const hal::MagSample& raw);
  bool take(Time now, const hal::BaroSample& raw, Parameters& parameters, Log& log);
  bool take(Time now, const hal::DiffPressureSample& raw, Parameters& parameters, Log& log);
  void filter_density(Time now, float density);
  bool take(const hal::GnssSample& raw);
  bool take(const hal::RangeSample& raw);
  bool take(const hal::BatterySample& raw);

  Config config_{};
  Matrix3 imu_mounting_{Matrix3::Identity()};
  Matrix3 mag_mounting_{Matrix3::Identity()};
  bool imu_rotated_{false};
  Measurements now_{};
  ImuClock imu_clock_;
  ImuClock::Step imu_step_{};
  ImuMean imu_mean_;
  GyroChain gyro_chain_;
  float gyro_chain_rate_Hz_{0.0f};  ///< For which it is configured; 0: not yet.
  float rate_window_s_{0.0f};
  int rate_samples_{0};
  bool gyro_filtered_{false};
  hal::Vec3 last_accel_{}, last_gyro_{};  ///< As they came.
  std::uint8_t equal_samples_{0};
  std::array<std::uint32_t, kRejects> rejected_{};
  ImuCalibration gyro_calibration_;
  ImuCalibration gravity_while_gyro_;  ///< Its spread shows a slow turn.
  ImuCalibration accel_calibration_;
  PressureCalibration baro_calibration_{25.0f};
  PressureCalibration airspeed_calibration_{100.0f};
  /// As they came: members, so that a pass without a sample need not clear it.
  struct Raw {
    hal::ImuSample imu;
    hal::GnssSample gnss;
    hal::BaroSample baro;
    hal::MagSample mag;
    hal::DiffPressureSample diff_pressure;
    hal::RangeSample range;
    hal::BatterySample battery;
  };
  Raw raw_{};
  Time baro_time_{};
  bool baro_seen_{false};
  bool battery_seen_{false};
};

}  // namespace rosflight::core
