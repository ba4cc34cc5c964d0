// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/leg.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/multirotor/angles.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kMinLeg_s = 1e-3;  // below this nothing moves
constexpr int kLimitSamples = 24;   // a quintic has at most three extrema of its first derivative
constexpr int kStretchings = 40;
constexpr double kStretch = 1.1;
constexpr double kMin_m_s = 0.05;  // two speeds below this never arrive

double rest_to_rest_s(double distance, double rate_limit, double acceleration_limit) {
  return std::max(kQuinticPeakSpeed * distance / rate_limit,
                  std::sqrt(kQuinticPeakAcceleration * distance / acceleration_limit));
}

}  // namespace

QuinticLeg::QuinticLeg(const Trajectory& start, const Vector3& target_W, double target_psi_rad,
                       const LegLimits& limits) {
  const double turn = wrap_angle(target_psi_rad - start.psi_rad);
  start_ << start.p_W, start.psi_rad;
  start_rate_ << start.v_W, start.psi_dot_rad_s;
  start_acceleration_ << start.a_W, start.psi_ddot_rad_s2;
  target_ << target_W, start.psi_rad + turn;
  double duration_s = std::max(
      rest_to_rest_s((target_W - start.p_W).norm(), limits.speed_m_s, limits.acceleration_m_s2),
      rest_to_rest_s(std::abs(turn), limits.yaw_rate_rad_s, limits.yaw_acceleration_rad_s2));
  const bool at_rest = start_rate_.isZero(0.0) && start_acceleration_.isZero(0.0);
  if (!at_rest) {
    duration_s = std::max({duration_s, kMinLeg_s, start.v_W.norm() / limits.acceleration_m_s2,
                           std::abs(start.psi_dot_rad_s) / limits.yaw_acceleration_rad_s2});
    fit(duration_s);
    for (int i = 0; i < kStretchings && !within(limits); ++i) fit(duration_s_ * kStretch);
  } else if (duration_s >= kMinLeg_s) {
    fit(duration_s);
  }
}

void QuinticLeg::fit(double duration_s) {
  duration_s_ = duration_s;
  inverse_duration_1_s_ = 1.0 / duration_s;
  const Vector4 c1 = start_rate_ * duration_s;
  const Vector4 bend = start_acceleration_ * (duration_s * duration_s);
  const Vector4 c2 = 0.5 * bend;
  const Vector4 rest = target_ - start_ - c1 - c2;
  const Vector4 rate = -c1 - bend;
  p_ = {start_,
        c1,
        c2,
        10.0 * rest - 4.0 * rate - 0.5 * bend,
        -15.0 * rest + 7.0 * rate + bend,
        6.0 * rest - 3.0 * rate - 0.5 * bend};
  for (std::size_t k = 0; k < v_.size(); ++k) {
    v_[k] = (static_cast<double>(k + 1) * inverse_duration_1_s_) * p_[k + 1];
  }
  for (std::size_t k = 0; k < a_.size(); ++k) {
    a_[k] = (static_cast<double>(k + 1) * inverse_duration_1_s_) * v_[k + 1];
  }
  for (std::size_t k = 0; k < j_.size(); ++k) {
    j_[k] = (static_cast<double>(k + 1) * inverse_duration_1_s_) * a_[k + 1];
  }
}

bool QuinticLeg::within(const LegLimits& limits) const {
  // What the start brings along cannot be undone: it widens the limit, with room for a smooth
  // decay.
  const double speed = std::max(limits.speed_m_s, 1.1 * start_rate_.head<3>().norm());
  const double acceleration =
      std::max(limits.acceleration_m_s2, 1.1 * start_acceleration_.head<3>().norm());
  const double yaw_rate = std::max(limits.yaw_rate_rad_s, 1.1 * std::abs(start_rate_[3]));
  const double yaw_acceleration =
      std::max(limits.yaw_acceleration_rad_s2, 1.1 * std::abs(start_acceleration_[3]));
  for (int i = 1; i < kLimitSamples; ++i) {
    const Trajectory at = sample(duration_s_ * i / kLimitSamples);
    if (at.v_W.norm() > speed || at.a_W.norm() > acceleration ||
        std::abs(at.psi_dot_rad_s) > yaw_rate || std::abs(at.psi_ddot_rad_s2) > yaw_acceleration) {
      return false;
    }
  }
  return true;
}

Trajectory QuinticLeg::sample(double t_s) const {
  Trajectory out;
  if (t_s >= duration_s_) {
    out.p_W = target_.head<3>();
    out.psi_rad = wrap_angle(target_[3]);
    return out;
  }
  const double tau = std::max(t_s, 0.0) * inverse_duration_1_s_;
  Vector4 p = p_[5];
  for (std::size_t k = 5; k-- > 0;) p = p_[k] + tau * p;
  Vector4 v = v_[4];
  for (std::size_t k = 4; k-- > 0;) v = v_[k] + tau * v;
  Vector4 a = a_[3];
  for (std::size_t k = 3; k-- > 0;) a = a_[k] + tau * a;
  out.p_W = p.head<3>();
  out.v_W = v.head<3>();
  out.a_W = a.head<3>();
  out.j_W = (j_[0] + tau * (j_[1] + tau * j_[2])).head<3>();
  out.psi_rad = wrap_angle(p[3]);
  out.psi_dot_rad_s = v[3];
  out.psi_ddot_rad_s2 = a[3];
  return out;
}

LinearLeg::LinearLeg(const Trajectory& start, const Vector3& target_W, double target_psi_rad,
                     double start_speed_m_s, double end_speed_m_s, const LegLimits& limits)
    : start_(start),
      target_W_(target_W),
      target_psi_rad_(wrap_angle(target_psi_rad)),
      psi_change_rad_(wrap_angle(target_psi_rad - start.psi_rad)),
      distance_m_((target_W - start.p_W).norm()),
      end_speed_m_s_(end_speed_m_s),
      start_speed_m_s_(start_speed_m_s) {
  direction_W_ = (target_W - start.p_W) / distance_m_;
  if (start_speed_m_s + end_speed_m_s > 2.0 * kMin_m_s) {
    duration_s_ = ramp_s_ = cruise_s_ = 2.0 * distance_m_ / (start_speed_m_s + end_speed_m_s);
    acceleration_m_s2_ = (end_speed_m_s - start_speed_m_s) / duration_s_;
    return;
  }
  start_speed_m_s_ = end_speed_m_s_ = 0.0;
  acceleration_m_s2_ = limits.acceleration_m_s2;
  const double peak = std::min(limits.speed_m_s, std::sqrt(distance_m_ * acceleration_m_s2_));
  ramp_s_ = peak / acceleration_m_s2_;
  cruise_s_ = distance_m_ / peak;
  duration_s_ = cruise_s_ + ramp_s_;
}

Trajectory LinearLeg::sample(double t_s) const {
  Trajectory out;
  if (t_s >= duration_s_) {
    out.p_W = target_W_;
    out.v_W = direction_W_ * end_speed_m_s_;
    out.psi_rad = target_psi_rad_;
    return out;
  }
  const double t = std::max(t_s, 0.0);
  double path_m = 0.0;
  double speed = 0.0;
  double acceleration = acceleration_m_s2_;
  if (t < ramp_s_) {
    path_m = t * (start_speed_m_s_ + 0.5 * acceleration * t);
    speed = start_speed_m_s_ + acceleration * t;
  } else if (t < cruise_s_) {
    speed = acceleration * ramp_s_;
    path_m = speed * (t - 0.5 * ramp_s_);
    acceleration = 0.0;
  } else {
    const double left_s = duration_s_ - t;
    path_m = distance_m_ - 0.5 * acceleration * left_s * left_s;
    speed = acceleration * left_s;
    acceleration = -acceleration;
  }
  out.p_W = start_.p_W + direction_W_ * path_m;
  out.v_W = direction_W_ * speed;
  out.a_W = direction_W_ * acceleration;
  const double turn_per_m = psi_change_rad_ / distance_m_;
  out.psi_rad = wrap_angle(start_.psi_rad + turn_per_m * path_m);
  out.psi_dot_rad_s = turn_per_m * speed;
  out.psi_ddot_rad_s2 = turn_per_m * acceleration;
  return out;
}

}  // namespace rosflight::autonomy::multirotor
