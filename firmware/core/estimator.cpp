// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/estimator.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kBoost = 10.0f;
/// Sine of 5 degrees: a vehicle that stands so level at power-up starts exactly level, as in
/// ROSflight 2.x, whose recorded traces and check values begin so.
constexpr float kLevelEnough = 0.0871557427f;
constexpr float kMicroseconds = 1e6f;  // in a second
constexpr float kRound = 0.5f;         // positive numbers to the nearest whole one
// Cosines of half the angles of 20 and 5 degrees.
constexpr float kCos10Deg = 0.984807753f;
constexpr float kCos2_5Deg = 0.999048222f;

/// True if the rotation between two unit quaternions is at most twice the angle of this cosine.
bool within(const Quaternion& a, const Quaternion& b, float cos_half_angle) {
  return std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z) >= cos_half_angle;
}

/// q turned by a constant body rate for a time.
inline Quaternion turned(const Quaternion& q, const Vector3& rate, float dt_s, bool exact) {
  const float speed_sq = rate.squaredNorm();
  if (!(speed_sq > 0.0f)) return q;
  Quaternion half{1.0f, 0.0f, 0.0f, 0.0f};
  float scale = 0.5f * dt_s;
  if (exact) {
    const float x_sq = 0.25f * speed_sq * dt_s * dt_s;  // x: half the angle of this step
    constexpr float kSeriesIsExact = 0.01f;             // next terms are below float resolution
    if (x_sq < kSeriesIsExact) {
      half.w = 1.0f - x_sq / 2.0f * (1.0f - x_sq / 12.0f);
      scale *= 1.0f - x_sq / 6.0f * (1.0f - x_sq / 20.0f);
    } else {
      const float speed = std::sqrt(speed_sq);
      const SinCos x = sin_cos(0.5f * speed * dt_s);
      half.w = x.cos;
      scale = x.sin / speed;
    }
  }
  half.x = scale * rate.x();
  half.y = scale * rate.y();
  half.z = scale * rate.z();
  return normalized(q * half);
}

/// Some unit vector perpendicular to the unit vector n.
Vector3 any_perpendicular(const Vector3& n) {
  constexpr float kNearX = 0.9f;
  const Vector3 other = std::abs(n.x()) < kNearX ? Vector3::UnitX() : Vector3::UnitY();
  return n.cross(other).normalized();
}

}  // namespace

void Estimator::reset() {
  estimate_ = AttitudeEstimate{};
  bias_.setZero();
  acc_ = {0.0f, 0.0f, -kGravity_m_s2};
  rate_.setZero();
  rate_1_.setZero();
  rate_2_.setZero();
  external_pending_ = false;
  external_run_ = 0;
  in_flight_ = false;
  healthy_ = true;
}

void Estimator::settle() {
  constexpr float kSettled = 0.0523f;  // sine of 3 degrees
  bias_.setZero();
  if (started_ && acc_.squaredNorm() > 0.0f && accelerometer_error().norm() > kSettled) {
    level_from_accelerometer();
  }
}

bool Motion::plausible() const {
  constexpr float kUnit = 0.01f, kMaxRate_rad_s = 2000.0f * kRadPerDeg, kMaxBias_rad_s = 0.35f;
  return std::abs(squared_norm(q_WB) - 1.0f) < kUnit &&  // false for NaN, as the others are
         (rates_rad_s.array().abs() <= kMaxRate_rad_s).all() &&
         (bias_rad_s.array().abs() <= kMaxBias_rad_s).all();
}

void Estimator::resume_in_flight(const Motion& before) {
  reset();
  started_ = false;
  in_flight_ = true;
  estimate_.stamp = Motion::kUnknown;
  if (!before.plausible()) return;
  estimate_.stamp = before.stamp;
  estimate_.q_WB = normalized(before.q_WB);
  bias_ = before.bias_rad_s;
  rate_ = before.rates_rad_s + bias_;
}

bool Estimator::set_external_attitude(const std::array<float, 4>& q_WB) {
  const Quaternion q{q_WB[0], q_WB[1], q_WB[2], q_WB[3]};
  const float norm_sq = squared_norm(q);
  const bool valid = norm_sq > 1e-6f && norm_sq < 1e6f;  // false for NaN
  if (!valid) external_run_ = 0;
  if (!valid || !external_plausible(normalized(q))) {
    ++external_rejected_;
    return false;
  }
  external_ = normalized(q);
  external_pending_ = true;
  return true;
}

bool Estimator::external_plausible(const Quaternion& q) {
  if (within(q, estimate_.q_WB, kCos10Deg)) {
    external_run_ = 0;
    return true;
  }
  const Quaternion expected = external_reference_ * conjugate(external_base_) *
                              estimate_.q_WB;  // propagated with the estimate
  const bool agrees = external_run_ > 0 && within(q, expected, kCos2_5Deg);
  external_run_ = agrees ? std::min(external_run_ + 1, kExternalRun) : 1;
  const bool taken = external_run_ == kExternalRun;
  // Until the run is complete each must agree with its first; afterwards with the previous one,
  // because the estimate moves towards them.
  if (!agrees || taken) {
    external_reference_ = q;
    external_base_ = estimate_.q_WB;
  }
  return taken;
}

const AttitudeEstimate& Estimator::step(const hal::ImuSample& imu, float dt_s) {
  if (!started_) {
    start(imu);
    return estimate_;
  }
  estimate_.stamp = imu.stamp;
  if (dt_s > kGap_s) {
    cross_gap(imu, dt_s);
    dt_s = 0.0f;
  }
  now_ += hal::microseconds(static_cast<std::int32_t>(dt_s * kMicroseconds + kRound));
  filter(imu);
  const Correction c = correction(dt_s);
  bias_ -= c.ki * dt_s * Vector3{c.error.x(), c.error.y(), c.yaw_bias_error};
  propagate(rate_for_step() - bias_ + c.kp * c.error, dt_s, config_.exact_step);
  publish();
  return estimate_;
}

inline void Estimator::publish() {
  estimate_.rates_rad_s = rate_ - bias_;
  estimate_.roll_rad = roll_of(estimate_.q_WB);
  estimate_.pitch_rad = pitch_of(estimate_.q_WB);
}

void Estimator::start(const hal::ImuSample& imu) {
  started_ = true;
  constexpr Time kLatest{std::int64_t{1} << 60};  // leaves room for sums with any first stamp
  now_ = std::clamp(imu.stamp, Time{0}, kLatest);
  last_use_ = external_time_ = boost_start_ = now_;
  const float gap_s = hal::seconds(now_ - estimate_.stamp);
  estimate_.stamp = imu.stamp;
  const Vector3 first = to_vector(imu.accel_m_s2);
  if (in_flight_) {
    acc_ = first;
    boost_start_ -= config_.init_time;
    cross_gap(imu, std::max(0.0f, gap_s));
    publish();
    return;
  }
  const float horizontal_sq = first.x() * first.x() + first.y() * first.y();
  if (horizontal_sq > kLevelEnough * kLevelEnough * first.squaredNorm()) {
    acc_ = first;
    level_from_accelerometer();
  }
}

void Estimator::cross_gap(const hal::ImuSample& imu, float dt_s) {
  constexpr float kMaxTime_s = 2000.0f;  // fits 32 bits of microseconds
  const Time gap{static_cast<std::int32_t>(std::min(dt_s, kMaxTime_s) * kMicroseconds)};
  now_ += gap;
  last_use_ += gap;  // health counts what was measured
  usable_since_ += gap;
  const Vector3 before = rate_;
  rate_ = rate_1_ = rate_2_ = to_vector(imu.gyro_rad_s);
  if (dt_s <= kMaxGap_s) {
    propagate(0.5f * (before + rate_) - bias_, dt_s, true);
    return;
  }
  acc_ = to_vector(imu.accel_m_s2);
  level_from_accelerometer();
  boost_start_ = now_;
}

inline void Estimator::filter(const hal::ImuSample& imu) {
  acc_ += (1.0f - config_.acc_lpf) * (to_vector(imu.accel_m_s2) - acc_);
  const float xy = 1.0f - config_.gyro_xy_lpf;
  const Vector3 blend{xy, xy, 1.0f - config_.gyro_z_lpf};
  rate_ += blend.cwiseProduct(to_vector(imu.gyro_rad_s) - rate_);
}

inline bool Estimator::accelerometer_usable(float norm_sq) const {
  const float low = (1.0f - config_.acc_margin) * kGravity_m_s2;
  const float high = (1.0f + config_.acc_margin) * kGravity_m_s2;
  return config_.use_acc && norm_sq > low * low && norm_sq < high * high;
}

inline Vector3 Estimator::accelerometer_error() const {
  const Vector3 n = acc_ * (1.0f / acc_.norm());
  const Quaternion& q = estimate_.q_WB;
  const Vector3 p{2.0f * (q.w * q.y - q.x * q.z), -2.0f * (q.w * q.x + q.y * q.z),
                  2.0f * (q.x * q.x + q.y * q.y) - 1.0f};
  Vector3 error = n.cross(p);
  if (n.dot(p) < 0.0f) {
    constexpr float kOpposite = 1e-3f;  // sine below which rounding determines the axis
    const float sine = error.norm();
    error = sine > kOpposite ? Vector3{error / sine} : any_perpendicular(n);
  }
  error.z() *= p.x() * p.x() + p.y() * p.y();
  return error;
}

Estimator::Correction Estimator::external_correction(float dt_s) {
  Correction c;
  external_pending_ = false;
  const Quaternion d = normalized(conjugate(estimate_.q_WB) * external_);
  const Vector3 s{d.x, d.y, d.z};
  const float length = s.norm();
  c.error = d.w >= length ? Vector3{4.0f * d.w * s} : Vector3{2.0f / length * s};
  c.kp = config_.ext_kp;
  c.ki = config_.ki;
  const float longest = c.kp > 0.0f ? 0.5f / c.kp : 0.0f;
  c.error *= std::min(hal::seconds(now_ - external_time_), longest) / dt_s;
  c.yaw_bias_error = c.error.z();
  external_time_ = last_use_ = now_;
  healthy_ = true;
  external_base_ = turned(estimate_.q_WB, c.kp * c.error, dt_s, true);
  return c;
}

inline Estimator::Correction Estimator::correction(float dt_s) {
  const bool usable = accelerometer_usable(acc_.squaredNorm());
  watch_health(usable);
  const bool boosted = now_ - boost_start_ < config_.init_time;
  if (external_pending_ && dt_s > 0.0f) return external_correction(dt_s);
  Correction c;
  c.ki = config_.ki;
  if (usable) {
    c.error = accelerometer_error();
    c.kp = config_.acc_kp;
  }
  if (boosted) {
    c.kp = kBoost * config_.acc_kp;
    c.ki = kBoost * config_.ki;
  }
  return c;
}

inline Vector3 Estimator::rate_for_step() {
  if (!config_.quadratic_rates) return rate_;
  const Vector3 fit = (5.0f * rate_ + 8.0f * rate_1_ - rate_2_) * (1.0f / 12.0f);
  rate_2_ = rate_1_;
  rate_1_ = rate_;
  return fit;
}

inline void Estimator::propagate(const Vector3& rate, float dt_s, bool exact) {
  estimate_.q_WB = turned(estimate_.q_WB, rate, dt_s, exact);
}

void Estimator::level_from_accelerometer() {
  if (!accelerometer_usable(acc_.squaredNorm())) return;
  const float roll = atan2(-acc_.y(), -acc_.z());
  const float pitch = atan2(acc_.x(), std::sqrt(acc_.y() * acc_.y() + acc_.z() * acc_.z()));
  estimate_.q_WB = normalized(quaternion_from_euler(roll, pitch, yaw_of(estimate_.q_WB)));
  estimate_.roll_rad = roll;
  estimate_.pitch_rad = pitch;
}

inline void Estimator::watch_health(bool used) {
  if (used && !was_usable_) usable_since_ = now_;
  if (used) last_use_ = now_;
  was_usable_ = used;
  const bool judged = config_.use_acc && !config_.fixed_wing;
  const bool well = used && now_ - usable_since_ >= kHealthyAfter;
  if (judged && now_ - last_use_ > kUnhealthyAfter) {
    healthy_ = false;
  } else if (!judged || well) {
    healthy_ = true;
  }
}

}  // namespace rosflight::core
