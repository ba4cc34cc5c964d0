// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rosflight::core {
namespace {

/// False for NaN, infinity and numbers beyond any sensor in SI units, so that sums and squares of
/// accepted samples are finite.
bool plausible(const hal::Vec3& v) {
  constexpr float kAbsurd = 1e6f;
  return std::abs(v[0]) < kAbsurd && std::abs(v[1]) < kAbsurd && std::abs(v[2]) < kAbsurd;
}

bool finite(const hal::GnssSample& s) {
  return std::isfinite(s.latitude_deg) && std::isfinite(s.longitude_deg) &&
         std::isfinite(s.height_msl_m) && plausible(s.velocity_ned_m_s);
}

/// A position on the Earth, below the altitude and speed limits of civil receivers (export rules).
bool in_range(const hal::GnssSample& s) {
  constexpr float kMinHeight_m = -1000.0f, kMaxHeight_m = 100e3f, kMaxSpeed_m_s = 1000.0f;
  const hal::Vec3& v = s.velocity_ned_m_s;
  return std::abs(s.latitude_deg) <= 90.0 && std::abs(s.longitude_deg) <= 360.0 &&
         s.height_msl_m >= kMinHeight_m && s.height_msl_m <= kMaxHeight_m &&
         std::abs(v[0]) <= kMaxSpeed_m_s && std::abs(v[1]) <= kMaxSpeed_m_s &&
         std::abs(v[2]) <= kMaxSpeed_m_s;
}

/// Within the widest ranges sold: +-4000 deg/s, +-400 g.
bool in_range(const hal::ImuSample& s) {
  constexpr float kMaxRate_rad_s = 125.0f, kMaxAcceleration_m_s2 = 7000.0f,
                  kMaxTemperature_K = 1000.0f;
  return to_vector(s.gyro_rad_s).squaredNorm() <= kMaxRate_rad_s * kMaxRate_rad_s &&
         to_vector(s.accel_m_s2).squaredNorm() <= kMaxAcceleration_m_s2 * kMaxAcceleration_m_s2 &&
         std::abs(s.temperature_K) <= kMaxTemperature_K;
}

bool same_bits(const hal::Vec3& a, const hal::Vec3& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
}

/// Six zeros: the result of a driver that could not read the part.
bool is_blank(const hal::ImuSample& s) {
  return s.gyro_rad_s[0] == 0.0f && s.gyro_rad_s == hal::Vec3{} && s.accel_m_s2 == hal::Vec3{};
}

hal::Vec3 to_array(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// v <- R(q)^T v, q from Euler angles.
Matrix3 mounting(const Vector3& deg) {
  const Vector3 rad = deg * kRadPerDeg;
  return rotation_matrix(quaternion_from_euler(rad.x(), rad.y(), rad.z())).transpose();
}

}  // namespace

void Sensors::configure(const Config& config) {
  // Rotations cost more than the rest together and rarely change.
  if (config.imu_mounting_deg != config_.imu_mounting_deg) {
    imu_mounting_ = mounting(config.imu_mounting_deg);
  }
  if (config.mag_mounting_deg != config_.mag_mounting_deg) {
    mag_mounting_ = mounting(config.mag_mounting_deg);
  }
  if (config.gyro_low_pass_Hz != config_.gyro_low_pass_Hz ||
      config.gyro_notch_Hz != config_.gyro_notch_Hz ||
      config.gyro_notch_width_Hz != config_.gyro_notch_width_Hz) {
    gyro_chain_rate_Hz_ = 0.0f;
    rate_samples_ = 0;
  }
  gyro_filtered_ = config.gyro_low_pass_Hz > 0.0f || config.gyro_notch_Hz > 0.0f;
  config_ = config;
  imu_rotated_ = !config.imu_mounting_deg.isZero(0.0f);
}

/// The slower sensors first, so that the faster ones do not delay them.
inline void Sensors::poll_aids(Time now, hal::Board& board, Parameters& parameters, Log& log) {
  if (now_.new_aid) {
    now_.new_aid = now_.new_gnss = now_.new_baro = now_.new_mag = false;
    now_.new_diff_pressure = now_.new_range = now_.new_battery = false;
  }
  const bool only_one = now_.new_imu;
  bool taken = false;
  const auto wanted = [&] { return !(taken && only_one); };
  if (board.gnss.poll(raw_.gnss)) {
    taken = true;
    now_.new_gnss = take(raw_.gnss);
  }
  if (wanted() && board.battery.poll(raw_.battery)) {
    taken = true;
    now_.new_battery = take(raw_.battery);
  }
  if (wanted() && board.range.poll(raw_.range)) {
    taken = true;
    now_.new_range = take(raw_.range);
  }
  if (wanted() && board.baro.poll(raw_.baro)) {
    taken = true;
    now_.new_baro = take(now, raw_.baro, parameters, log);
  }
  if (wanted() && board.mag.poll(raw_.mag)) {
    taken = true;
    now_.new_mag = take(raw_.mag);
  }
  if (wanted() && board.diff_pressure.poll(raw_.diff_pressure)) {
    taken = true;
    now_.new_diff_pressure = take(now, raw_.diff_pressure, parameters, log);
  }
  now_.new_aid = taken;
}

Sensors::CalibrationEvents Sensors::step(Time now, hal::Board& board, Parameters& parameters,
                                         Log& log) {
  CalibrationEvents events;
  now_.new_imu = take_imu(now, board, parameters, log, events);
  poll_aids(now, board, parameters, log);
  return events;
}

/// The filters need the sample rate: it is measured over 200 samples, during which nothing is
/// filtered, and monitored afterwards.
void Sensors::filter_gyro(hal::ImuSample& raw, Log& log) {
  constexpr int kSamples = 200;
  constexpr float kMaxStep_s = 0.025f;  // a gap does not show the rate
  constexpr float kTolerance = 0.05f;
  const float dt_s = imu_step_.dt_s;
  if (dt_s > 0.0f && dt_s < kMaxStep_s) {
    if (rate_samples_ == 0) rate_window_s_ = 0.0f;
    rate_window_s_ += dt_s;
    if (++rate_samples_ == kSamples) {
      rate_samples_ = 0;
      const float rate_Hz = static_cast<float>(kSamples) / rate_window_s_;
      if (std::abs(rate_Hz - gyro_chain_rate_Hz_) > kTolerance * gyro_chain_rate_Hz_) {
        configure_gyro_chain(rate_Hz, log);
      }
    }
  }
  if (gyro_chain_rate_Hz_ == 0.0f) return;
  raw.gyro_rad_s = to_array(gyro_chain_.step(to_vector(raw.gyro_rad_s)));
  rejected_[static_cast<std::size_t>(Reject::kGyroClipped)] = gyro_chain_.clipped();
}

void Sensors::configure_gyro_chain(float rate_Hz, Log& log) {
  constexpr float kFullScale_rad_s = 2000.0f * kRadPerDeg;  // full scale of the gyros on boards
  gyro_chain_rate_Hz_ = rate_Hz;
  GyroChain::Config c;
  c.sample_rate_Hz = rate_Hz;
  c.low_pass_Hz = config_.gyro_low_pass_Hz;
  c.notch_Hz = config_.gyro_notch_Hz;
  c.notch_width_Hz = config_.gyro_notch_width_Hz;
  c.full_scale_rad_s = kFullScale_rad_s;
  const GyroChain::Refused refused = gyro_chain_.configure(c);
  const float limit_Hz = GyroChain::kMaxFrequencyRatio * rate_Hz;
  if (refused.low_pass) {
    log.error(Text("GYRO_LPF_HZ off: not below ").add(limit_Hz, 0).add(" Hz"));
  }
  if (refused.notch) {
    log.error(Text("GYRO_NOTCH_HZ, BW off: not below ").add(limit_Hz, 0).add(" Hz"));
  }
}

/// Equal bit by bit to the nineteen samples before it, or more.
inline bool Sensors::stuck(const hal::ImuSample& raw) {
  constexpr std::uint8_t kStuck = 20;
  if (!same_bits(raw.gyro_rad_s, last_gyro_) || !same_bits(raw.accel_m_s2, last_accel_)) {
    last_gyro_ = raw.gyro_rad_s;
    last_accel_ = raw.accel_m_s2;
    equal_samples_ = 1;
    return false;
  }
  if (equal_samples_ < kStuck) ++equal_samples_;
  return equal_samples_ >= kStuck;
}

inline bool Sensors::usable(Time now, const hal::ImuSample& raw) {
  if (!in_range(raw)) {
    const bool finite =
        plausible(raw.accel_m_s2) && plausible(raw.gyro_rad_s) && std::isfinite(raw.temperature_K);
    return reject(finite ? Reject::kRange : Reject::kNotFinite);
  }
  if (is_blank(raw) || stuck(raw)) return reject(Reject::kStuck);
  imu_step_ = imu_clock_.step(raw.stamp, now);
  if (imu_step_.usable) return true;
  return reject(imu_step_.standing    ? Reject::kStuck
                : imu_step_.backwards ? Reject::kBackwards
                                      : Reject::kOutlier);
}

/// All samples that wait, so that a pass which comes late leaves none behind; but no more than a driver keeps: a source
/// that never ends must not keep the pass.
inline bool Sensors::poll_imu(Time now, hal::Board& board, Log& log) {
  constexpr int kMostWaiting = 4;
  for (int k = 0; k < kMostWaiting && board.imu.poll(raw_.imu); ++k) {
    if (!usable(now, raw_.imu)) continue;
    if (gyro_filtered_) filter_gyro(raw_.imu, log);
    imu_mean_.add(raw_.imu, imu_step_.dt_s);
  }
  return imu_mean_.take(raw_.imu, imu_step_.dt_s);
}

bool Sensors::take_imu(Time now, hal::Board& board, Parameters& parameters, Log& log,
                       CalibrationEvents& events) {
  if (!poll_imu(now, board, log)) return false;
  const hal::ImuSample& raw = raw_.imu;
  Vector3 accel = to_vector(raw.accel_m_s2);
  Vector3 gyro = to_vector(raw.gyro_rad_s);
  if (imu_rotated_) {
    accel = imu_mounting_ * accel;
    gyro = imu_mounting_ * gyro;
  }
  if (calibrating_imu()) {
    calibrate(accel, gyro, raw.temperature_K, parameters, log, events);
  } else {
    accel -= config_.acc_temp_comp * raw.temperature_K;
    accel -= config_.acc_bias;
    gyro -= config_.gyro_bias;
  }
  now_.imu = {raw.stamp, to_array(accel), to_array(gyro), raw.temperature_K};
  return true;
}

bool Sensors::take(const hal::MagSample& raw) {
  if (!plausible(raw.field_T)) return reject(Reject::kNotFinite);
  const Vector3 field =
      config_.mag_soft_iron * (mag_mounting_ * to_vector(raw.field_T) - config_.mag_bias);
  now_.mag = {raw.stamp, to_array(field), raw.temperature_K};
  return true;
}

bool Sensors::take(Time now, const hal::BaroSample& raw, Parameters& parameters, Log& log) {
  constexpr float kMin_Pa = 30e3f, kMax_Pa = 120e3f;  // 9000 m high, 1400 m below the sea
  if (!std::isfinite(raw.pressure_Pa)) return reject(Reject::kNotFinite);
  if (raw.pressure_Pa < kMin_Pa || raw.pressure_Pa > kMax_Pa) {
    return reject(Reject::kPressure);
  }
  if (baro_calibration_.running()) calibrate_baro(now, raw.pressure_Pa, parameters, log);
  now_.baro = raw;
  now_.altitude_m = pressure_altitude_m(raw.pressure_Pa);
  filter_density(now, air_density_kg_m3(raw.pressure_Pa));
  return true;
}

/// The density changes slowly; a wrong sample must not change the thrust.
void Sensors::filter_density(Time now, float density) {
  constexpr float kTimeConstant_s = 5.0f;
  constexpr Time kMaxStep = hal::milliseconds(50);  // limit of one sample's weight
  const float dt_s = hal::seconds(std::min(now - baro_time_, kMaxStep));
  const float share = baro_seen_ ? dt_s / (kTimeConstant_s + dt_s) : 1.0f;
  now_.density_kg_m3 += share * (density - now_.density_kg_m3);
  baro_time_ = now;
  baro_seen_ = true;
}

bool Sensors::take(Time now, const hal::DiffPressureSample& raw, Parameters& parameters, Log& log) {
  constexpr float kMax_Pa = 50e3f;  // 280 m/s
  if (!std::isfinite(raw.pressure_Pa)) return reject(Reject::kNotFinite);
  if (std::abs(raw.pressure_Pa) > kMax_Pa) return reject(Reject::kRange);
  if (airspeed_calibration_.running()) calibrate_airspeed(now, raw.pressure_Pa, parameters, log);
  now_.diff_pressure = raw;
  now_.diff_pressure.pressure_Pa -= config_.diff_pressure_bias_Pa;
  const float p = now_.diff_pressure.pressure_Pa;
  now_.airspeed_m_s = std::copysign(std::sqrt(std::abs(p) / (0.5f * kSeaLevelDensity_kg_m3)), p);
  return true;
}

bool Sensors::take(const hal::GnssSample& raw) {
  if (!finite(raw)) return reject(Reject::kNotFinite);
  if (!in_range(raw)) return reject(Reject::kRange);
  now_.gnss = raw;
  return true;
}

bool Sensors::take(const hal::RangeSample& raw) {
  if (std::isnan(raw.range_m)) return reject(Reject::kNotFinite);
  if (raw.range_m < 0.0f) return reject(Reject::kRange);
  now_.range = raw;
  return true;
}

bool Sensors::take(const hal::BatterySample& raw) {
  if (!std::isfinite(raw.voltage_V) || !std::isfinite(raw.current_A)) {
    return reject(Reject::kNotFinite);
  }
  constexpr float kNoise_V = -1.0f;  // noise of a converter without a battery
  constexpr float kMaxVoltage_V = 100.0f, kMaxCurrent_A = 2000.0f;
  if (raw.voltage_V < kNoise_V || raw.voltage_V > kMaxVoltage_V ||
      std::abs(raw.current_A) > kMaxCurrent_A) {
    return reject(Reject::kRange);
  }
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
