// SPDX-License-Identifier: BSD-3-Clause
// What an AidFusion does when aids and prediction disagree for long, and after a break of time.
#include <algorithm>
#include <cmath>

#include "autonomy/estimation/aid_fusion.hpp"

namespace rosflight::autonomy::estimation {
namespace {

/// Variances are widened no more often than this.
constexpr double kWidenEvery_s = 0.3;

}  // namespace

/// The velocity drifts away from what aids it: a bias must have jumped. Adds to the covariance what a
/// jump of unknown size, `age_s` ago, has led to by now (A. S. Willsky, H. L. Jones, IEEE Trans.
/// Automatic Control 21, 1976: a jump by its signature). With a the specific force, for a jump b of
/// the gyro and c of the accelerometer:
///
///     dbg = b, dtheta = -b T, dv = R [a]x b T^2/2;    dba = c, dv = -R c T
///
/// so that tilt and velocity follow their cause, and a tilt that no bias explains stays where it is.
void AidFusion::widen_imu_errors(const ImuFault& fault) {
  if (t_s_ - widened_s_ < kWidenEvery_s) return;
  widened_s_ = t_s_;
  constexpr double kTilt_rad = 0.02;  // besides
  constexpr double kVelocity_m_s = 0.1;
  const Matrix3 R = filter_.state().q_WB.toRotationMatrix();
  const Vector3 down_B = R.row(2).transpose();
  // A magnetometer that is wrong would pass the gate of a heading widened with the tilt.
  const Matrix3 level =
      Matrix3::Identity() - (heading_.jumped ? 1.0 : 0.0) * down_B * down_B.transpose();
  const Vector3 up_B = -config_.gravity_m_s2 * down_B;
  Eigen::Matrix<double, Filter::kSize, 6> by = Eigen::Matrix<double, Filter::kSize, 6>::Zero();
  const double T = fault.age_s;
  by.block<3, 3>(Filter::kGyroBias, 0) = fault.gyro_rad_s * level;
  by.block<3, 3>(Filter::kTheta, 0) = -T * fault.gyro_rad_s * level;
  by.block<3, 3>(Filter::kVelocity, 0) = 0.5 * T * T * fault.gyro_rad_s * R * skew(up_B) * level;
  by.block<3, 3>(Filter::kAccelBias, 3) = fault.accel_m_s2 * Matrix3::Identity();
  by.block<3, 3>(Filter::kVelocity, 3) = -T * fault.accel_m_s2 * R;
  auto& P = filter_.covariance();
  P.noalias() += by * by.transpose();
  P.block<3, 3>(Filter::kTheta, Filter::kTheta) += kTilt_rad * kTilt_rad * level;
  P.block<3, 3>(Filter::kVelocity, Filter::kVelocity) +=
      kVelocity_m_s * kVelocity_m_s * Matrix3::Identity();
  // The wind has taken in part of the force; without GNSS it is all that the velocity rests on.
  constexpr double kWind_m_s = 0.5;
  if (!dead_reckoning()) {
    P.block<2, 2>(Filter::kWind, Filter::kWind) +=
        kWind_m_s * kWind_m_s * Eigen::Matrix2d::Identity();
  }
  ++health_.imu_widenings;
}

/// Whether the altitude drifts away from that of the barometer as with an accelerometer that is wrong,
/// counted from the last altitude that was used.
bool AidFusion::height_drifts(const Filter::Residual<1>& residual) {
  constexpr double kSigmas = 5.0;
  constexpr double kVelocity_m_s = 3.0;  // what it has led to by then
  constexpr double kAcceleration_m_s2 = 10.0;
  if (!health_.of(Aid::kBaro).rejecting) {
    height_.residual_m = residual.nu(0);
    height_.t_s = t_s_;
    height_.jumped = false;
    return false;
  }
  const double since_s = t_s_ - height_.t_s;
  const double possible_m = kSigmas * std::sqrt(residual.R(0)) + kVelocity_m_s * since_s +
                            0.5 * kAcceleration_m_s2 * since_s * since_s;
  height_.jumped = height_.jumped || std::abs(residual.nu(0) - height_.residual_m) > possible_m;
  return !height_.jumped;
}

/// The altitude drifts, and nothing but the barometer aids it: adds to the covariance what a jump of
/// the specific force along the vertical, some time ago, has led to by now.
void AidFusion::widen_vertical() {
  if (t_s_ - height_.widened_s < kWidenEvery_s) return;
  height_.widened_s = t_s_;
  constexpr double kAcceleration_m_s2 = 2.0;
  constexpr double T = 0.7;  // [s]
  Filter::Error by = Filter::Error::Zero();
  by.segment<3>(Filter::kAccelBias) =
      kAcceleration_m_s2 * filter_.state().q_WB.toRotationMatrix().row(2).transpose();
  by(Filter::kVelocity + 2) = -T * kAcceleration_m_s2;
  by(Filter::kPosition + 2) = -0.5 * T * T * kAcceleration_m_s2;
  auto& P = filter_.covariance();
  P.noalias() += by * by.transpose();
  constexpr double kVelocity_m_s = 0.5;  // besides
  constexpr double kPosition_m = 0.5;
  P(Filter::kVelocity + 2, Filter::kVelocity + 2) += kVelocity_m_s * kVelocity_m_s;
  P(Filter::kPosition + 2, Filter::kPosition + 2) += kPosition_m * kPosition_m;
  ++health_.imu_widenings;
}

/// Horizontal position and velocity as GNSS has them, less its slow error; the height only where it
/// has no other aid.
void AidFusion::reset_to_gnss(const Vector3& p_W, const Vector3& v_W) {
  constexpr double kTilt_rad = 0.05;
  NominalState& x = filter_.state();
  const Vector3 lever_W = x.q_WB * gnss_lever();
  x.p_W.head<2>() = (p_W - x.gnss_bias_W - lever_W).head<2>();
  x.v_W = v_W;
  filter_.couple(Filter::kPosition, Filter::kGnssBias, 2, 2.0 * config_.gnss_horizontal_sigma_m);
  filter_.reset_variance(Filter::kVelocity, 3, 5.0 * config_.gnss_velocity_sigma_m_s);
  for (int k = 0; k < 3; ++k) {  // the same error has turned the attitude too
    filter_.covariance()(Filter::kTheta + k, Filter::kTheta + k) += kTilt_rad * kTilt_rad;
  }
  for (const Aid aid : {Aid::kGnssHorizontal, Aid::kGnssVelocity}) {
    health_.of(aid).rejecting = false;
    health_.of(aid).last_accepted_s = t_s_;
  }
  ++health_.gnss_resets;
}

/// Sets the slow error of axes of the satellites' position so that they have no residual.
void AidFusion::restart_gnss_bias(int first, int size, const Vector3& p_W) {
  NominalState& x = filter_.state();
  const Vector3 residual = Filter::gnss_position(x, p_W, gnss_lever()).nu;
  x.gnss_bias_W.segment(first, size) += residual.segment(first, size);
  filter_.couple(Filter::kGnssBias + first, Filter::kPosition + first, size,
                 first == 2 ? config_.gnss_altitude_sigma_m : config_.gnss_horizontal_sigma_m);
  ++health_.gnss_jumps;
}

void AidFusion::correct_attitude(const Vector3& error_B, double tilt_sigma_rad,
                                 double heading_sigma_rad) {
  Filter::Error dx = Filter::Error::Zero();
  dx.segment<3>(Filter::kTheta) = error_B;
  step_watch_.restart();
  filter_.inject(dx);
  filter_.reset_variance(Filter::kTheta, 3, tilt_sigma_rad);
  const Vector3 down_B = filter_.state().q_WB.conjugate() * Vector3::UnitZ();
  const double more = heading_sigma_rad * heading_sigma_rad - tilt_sigma_rad * tilt_sigma_rad;
  filter_.covariance().block<3, 3>(Filter::kTheta, Filter::kTheta) +=
      more * down_B * down_B.transpose();
}

void AidFusion::guard() {
  constexpr double kEvery_s = 1.0;
  const NominalState& x = filter_.state();
  const double sum = x.p_W.sum() + x.v_W.sum() + x.q_WB.coeffs().sum() + x.gyro_bias_B.sum() +
                     x.accel_bias_B.sum() + filter_.covariance().diagonal().sum();
  const bool good = std::isfinite(sum) && filter_.covariance().diagonal().minCoeff() >= 0.0;
  if (good) {
    if (t_s_ - good_.t_s < kEvery_s) return;
    good_ = {t_s_, x, filter_.lower_covariance()};
    return;
  }
  if (good_.t_s < 0.0) return;
  const double gone_s = std::max(0.0, t_s_ - good_.t_s);
  filter_.state() = good_.state;
  filter_.set_lower_covariance(good_.covariance);
  t_s_ -= gone_s;
  predict({t_s_, {gone_s, Vector3::Zero(), Vector3::Zero()}, true, true});
  ++health_.restarts;
}

void AidFusion::shift(double by_s) {
  for (double* t_s : {&t_s_, &newest_s_, &jump_.t_s, &jump_.until_s, &heading_.t_s,
                      &heading_.widened_s, &height_.t_s, &height_.widened_s, &widened_s_,
                      &long_hole_end_s_, &settled_since_s_, &started_on_fixes_s_, &good_.t_s}) {
    *t_s += by_s;
  }
  for (AidHealth& aid : health_.aids) {
    aid.last_accepted_s += by_s;
    aid.last_rejected_s += by_s;
    aid.rejected_since_s += by_s;
  }
  ++health_.realigned;
}

}  // namespace rosflight::autonomy::estimation
