// SPDX-License-Identifier: BSD-3-Clause
#include "geometric_controller.hpp"

#include <algorithm>
#include <cmath>

namespace own_controller {
namespace {

using Matrix3 = Eigen::Matrix3d;
using rosflight::autonomy::multirotor::ControlMode;

Vector3 limited(const Vector3& v, double max_length) {
  const double length = v.norm();
  return length > max_length ? Vector3(v * (max_length / length)) : v;
}

/// Body axes that point z against f_W and the nose along psi.
Matrix3 attitude_for(const Vector3& f_W, double psi_rad) {
  const Vector3 b3 = -f_W.normalized();
  const Vector3 nose{std::cos(psi_rad), std::sin(psi_rad), 0.0};
  const Vector3 b2 = b3.cross(nose).normalized();
  Matrix3 R;
  R << b2.cross(b3), b2, b3;
  return R;
}

}  // namespace

void GeometricController::restart(const Vector3& trim_W) {
  integral_W_ = trim_W;
  rate_B_.setZero();
  last_ = {};
}

Vector3 GeometricController::specific_force(const Input& in) {
  const Vector3 e_p = limited(in.state.p_W - in.setpoint.p_W, config_.max_distance_m);
  const Vector3 e_v = in.state.v_W - in.setpoint.v_W;
  const double limit = config_.max_integral_m_s2;
  if (!in.pilot.any()) {
    integral_W_ -= config_.ki_1_s3 * in.dt_s * e_p;
    integral_W_ = integral_W_.cwiseMax(-limit).cwiseMin(limit);
  }
  Vector3 a_W = in.setpoint.a_W + config_.drag_1_s * in.setpoint.v_W - config_.kp_1_s2 * e_p -
                config_.kv_1_s * e_v + integral_W_;
  a_W.head<2>() *=
      std::min(1.0, config_.max_acceleration_m_s2 / std::max(a_W.head<2>().norm(), 1e-9));
  a_W.z() = std::min(a_W.z(), config_.max_acceleration_m_s2);
  return a_W - config_.gravity_m_s2 * Vector3::UnitZ();
}

ControllerCommand GeometricController::step(const Input& in) {
  const double sum = in.state.p_W.sum() + in.state.v_W.sum() + in.setpoint.p_W.sum() +
                     in.setpoint.v_W.sum() + in.setpoint.a_W.sum() + in.setpoint.psi_rad;
  if (!std::isfinite(sum)) return {};  // not valid: the state machine holds the position
  if (!(in.dt_s > 0.0)) return last_;
  if (in.pilot.any()) {
    integral_W_.setZero();
    rate_B_.setZero();
  }

  const Vector3 f_W = specific_force(in);
  const Matrix3 R = in.state.q_WB.toRotationMatrix();
  const Matrix3 twice = attitude_for(f_W, in.setpoint.psi_rad).transpose() * R;
  const Matrix3 skew = 0.5 * (twice - twice.transpose());
  const Vector3 e_R{skew(2, 1), skew(0, 2), skew(1, 0)};
  constexpr double kMaxRate_rad_s = 2.0;
  rate_B_ = (rate_B_ - config_.ki_r_1_s2 * in.dt_s * e_R)
                .cwiseMax(-kMaxRate_rad_s)
                .cwiseMin(kMaxRate_rad_s);
  const Vector3 b3 = -f_W.normalized();
  const Vector3 f_dot_W = in.setpoint.j_W + config_.drag_1_s * in.setpoint.a_W;
  const Vector3 b3_dot = (f_dot_W.dot(b3) * b3 - f_dot_W) / f_W.norm();
  const Vector3 turn_W = b3.cross(b3_dot) + in.setpoint.psi_dot_rad_s * Vector3::UnitZ();
  const Vector3 w_B = -config_.kr_1_s * e_R + rate_B_ + R.transpose() * turn_W;
  last_.mode = ControlMode::kRollratePitchrateYawrateThrust;
  last_.cmd = {w_B.x(), w_B.y(), w_B.z(), std::max(-config_.mass_kg * f_W.dot(R.col(2)), 0.0)};
  last_.valid = true;
  return last_;
}

}  // namespace own_controller
