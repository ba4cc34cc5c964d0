// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/estimator.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kBoost = 10.0f;

}  // namespace

void Estimator::reset() {
  estimate_ = AttitudeEstimate{};
  bias_.setZero();
  acc_ = {0.0f, 0.0f, -kGravity_m_s2};
  rate_.setZero();
  rate_1_.setZero();
  rate_2_.setZero();
  boost_start_ = Time{0};
  external_pending_ = false;
  in_flight_ = false;
  healthy_ = true;
}

void Estimator::reset_in_flight() {
  reset();
  started_ = false;
  in_flight_ = true;
}

bool Estimator::set_external_attitude(const std::array<float, 4>& q_NB) {
  const Quaternion q{q_NB[0], q_NB[1], q_NB[2], q_NB[3]};
  const float norm_sq = squared_norm(q);
  if (!std::isfinite(norm_sq) || norm_sq <= 1e-6f || norm_sq >= 1e6f) return false;
  external_ = normalized(q);
  external_pending_ = true;
  return true;
}

const AttitudeEstimate& Estimator::step(const hal::ImuSample& imu, float dt_s) {
  estimate_.stamp = imu.stamp;
  if (!started_) {
    started_ = true;
    last_acc_use_ = imu.stamp;
    external_time_ = imu.stamp;
    if (in_flight_) {
      boost_start_ = imu.stamp;
      acc_ = to_vector(imu.accel_m_s2);
      level_from_accelerometer();
    }
    return estimate_;
  }
  if (dt_s > kLongestGap_s) {
    acc_ = to_vector(imu.accel_m_s2);
    rate_ = rate_1_ = rate_2_ = to_vector(imu.gyro_rad_s);
    level_from_accelerometer();
    boost_start_ = imu.stamp;
    in_flight_ = true;
    dt_s = 0.0f;
  }
  filter(imu);
  const Correction c = correction(imu.stamp, dt_s);
  bias_ -= c.ki * dt_s * c.error;
  propagate(rate_for_step() - bias_ + c.kp * c.error, dt_s);

  estimate_.rates_rad_s = rate_ - bias_;
  estimate_.roll_rad = roll_of(estimate_.q_NB);
  estimate_.pitch_rad = pitch_of(estimate_.q_NB);
  return estimate_;
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
  const Vector3 n = acc_ / acc_.norm();
  const float d = -n.z();  // cosine between (0, 0, -1) and n
  constexpr float kUpsideDown = -0.9999f;
  if (d >= 1.0f || d <= kUpsideDown) return Vector3::Zero();
  const float s = std::sqrt(2.0f * (1.0f + d));
  const Quaternion shortest{s / 2.0f, n.y() / s, -n.x() / s, 0.0f};
  const Quaternion q = estimate_.q_NB * shortest;
  return {-2.0f * q.w * q.x, -2.0f * q.w * q.y, 0.0f};
}

inline Estimator::Correction Estimator::correction(Time now, float dt_s) {
  Correction c;
  c.ki = config_.ki;
  const bool usable = accelerometer_usable(acc_.squaredNorm());
  watch_health(now, usable);
  const bool boosted = now - boost_start_ < config_.init_time;
  if (external_pending_) {
    external_pending_ = false;
    const Matrix3 R = rotation_matrix(estimate_.q_NB);
    const Matrix3 S = rotation_matrix(external_);
    for (int i = 0; i < 3; ++i) {
      c.error += Vector3{S.row(i).transpose()}.cross(Vector3{R.row(i).transpose()});
    }
    c.kp = config_.ext_kp;
    if (boosted && !in_flight_) {
      c.kp = kBoost * config_.acc_kp;
      c.ki = kBoost * config_.ki;
    }
    const float longest = c.kp > 0.0f ? 0.5f / c.kp : 0.0f;
    const float interval = std::min(hal::seconds(now - external_time_), longest);
    c.error *= dt_s > 0.0f ? interval / dt_s : 0.0f;
    external_time_ = now;
    return c;
  }
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

inline void Estimator::propagate(const Vector3& rate, float dt_s) {
  const float speed_sq = rate.squaredNorm();
  if (!(speed_sq > 0.0f)) return;
  Quaternion half{1.0f, 0.0f, 0.0f, 0.0f};
  float scale = 0.5f * dt_s;
  if (config_.exact_step) {
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
  estimate_.q_NB = normalized(estimate_.q_NB * half);
}

void Estimator::level_from_accelerometer() {
  if (!accelerometer_usable(acc_.squaredNorm())) return;
  const float roll = atan2(-acc_.y(), -acc_.z());
  const float pitch = atan2(acc_.x(), std::sqrt(acc_.y() * acc_.y() + acc_.z() * acc_.z()));
  estimate_.q_NB = normalized(quaternion_from_euler(roll, pitch, yaw_of(estimate_.q_NB)));
  estimate_.roll_rad = roll;
  estimate_.pitch_rad = pitch;
}

inline void Estimator::watch_health(Time now, bool used) {
  if (used && !was_usable_) usable_since_ = now;
  if (used) last_acc_use_ = now;
  was_usable_ = used;
  const bool judged = config_.use_acc && !config_.fixed_wing;
  const bool well = used && now - usable_since_ >= kHealthyAfter;
  if (judged && now - last_acc_use_ > kUnhealthyAfter) {
    healthy_ = false;
  } else if (!judged || well) {
    healthy_ = true;
  }
}

}  // namespace rosflight::core
