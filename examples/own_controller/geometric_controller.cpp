// SPDX-License-Identifier: BSD-3-Clause
#include "examples/own_controller/geometric_controller.hpp"

#include <algorithm>
#include <cmath>

namespace own_controller {
namespace {

using Matrix3 = Eigen::Matrix3d;
using rosflight::autonomy::ControlMode;

Vector3 limited(const Vector3& v, double most) {
  const double length = v.norm();
  return length > most ? Vector3(v * (most / length)) : v;
}

/// Body axes that point z against f_N and the nose along psi.
Matrix3 attitude_for(const Vector3& f_N, double psi_rad) {
  const Vector3 b3 = -f_N.normalized();
  const Vector3 nose{std::cos(psi_rad), std::sin(psi_rad), 0.0};
  const Vector3 b2 = b3.cross(nose).normalized();
  Matrix3 R;
  R << b2.cross(b3), b2, b3;
  return R;
}

}  // namespace

void GeometricController::restart(const Vector3& trim_N) {
  integral_N_ = trim_N;
  rate_B_.setZero();
  last_ = {};
}

Vector3 GeometricController::specific_force(const Input& in) {
  const Vector3 e_p = limited(in.state.p_N - in.setpoint.p_N, config_.most_distance_m);
  const Vector3 e_v = in.state.v_N - in.setpoint.v_N;
  const double most = config_.most_integral_m_s2;
  if (!in.pilot.any()) {
    integral_N_ -= config_.ki_1_s3 * in.dt_s * e_p;
    integral_N_ = integral_N_.cwiseMax(-most).cwiseMin(most);
  }
  Vector3 a_N = in.setpoint.a_N + config_.drag_1_s * in.setpoint.v_N - config_.kp_1_s2 * e_p -
                config_.kv_1_s * e_v + integral_N_;
  a_N.head<2>() *= std::min(1.0, config_.most_m_s2 / std::max(a_N.head<2>().norm(), 1e-9));
  a_N.z() = std::min(a_N.z(), config_.most_m_s2);
  return a_N - config_.gravity_m_s2 * Vector3::UnitZ();
}

ControllerCommand GeometricController::step(const Input& in) {
  const double sum = in.state.p_N.sum() + in.state.v_N.sum() + in.setpoint.p_N.sum() +
                     in.setpoint.v_N.sum() + in.setpoint.a_N.sum() + in.setpoint.psi_rad;
  if (!std::isfinite(sum)) return {};  // not valid: the state machine holds the position
  if (!(in.dt_s > 0.0)) return last_;
  if (in.pilot.any()) {
    integral_N_.setZero();
    rate_B_.setZero();
  }

  const Vector3 f_N = specific_force(in);
  const Matrix3 R = in.state.q_NB.toRotationMatrix();
  const Matrix3 twice = attitude_for(f_N, in.setpoint.psi_rad).transpose() * R;
  const Matrix3 skew = 0.5 * (twice - twice.transpose());
  const Vector3 e_R{skew(2, 1), skew(0, 2), skew(1, 0)};
  constexpr double kMostRate_rad_s = 2.0;
  rate_B_ = (rate_B_ - config_.ki_r_1_s2 * in.dt_s * e_R)
                .cwiseMax(-kMostRate_rad_s)
                .cwiseMin(kMostRate_rad_s);
  const Vector3 b3 = -f_N.normalized();
  const Vector3 f_dot_N = in.setpoint.j_N + config_.drag_1_s * in.setpoint.a_N;
  const Vector3 b3_dot = (f_dot_N.dot(b3) * b3 - f_dot_N) / f_N.norm();
  const Vector3 turn_N = b3.cross(b3_dot) + in.setpoint.psi_dot_rad_s * Vector3::UnitZ();
  const Vector3 w_B = -config_.kr_1_s * e_R + rate_B_ + R.transpose() * turn_N;
  last_.mode = ControlMode::kRollratePitchrateYawrateThrust;
  last_.cmd = {w_B.x(), w_B.y(), w_B.z(), std::max(-config_.mass_kg * f_N.dot(R.col(2)), 0.0)};
  last_.valid = true;
  return last_;
}

}  // namespace own_controller
