// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <cmath>

/// Rotations as the filter needs them. J. Sola, "Quaternion kinematics for the error-state Kalman
/// filter", 2017 (arXiv:1711.02508): exponential eq. (101), right Jacobian eq. (183).
namespace rosflight::autonomy::estimation {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// The matrix with skew(a) b = a x b.
inline Matrix3 skew(const Vector3& a) {
  Matrix3 m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

/// Rotation by |phi| about phi.
inline Quaternion exp_rotation(const Vector3& phi) {
  const double square = phi.squaredNorm();
  constexpr double kSmall = 1e-8;  // rad^2: the fourth-order terms left out are below 1e-17
  double scale = 0.5 - square / 48.0;
  double w = 1.0 - square / 8.0;
  if (square > kSmall) {
    const double angle = std::sqrt(square);
    scale = std::sin(0.5 * angle) / angle;
    w = std::cos(0.5 * angle);
  }
  return {w, scale * phi.x(), scale * phi.y(), scale * phi.z()};
}

/// The rotation vector of the shorter turn, |phi| <= pi.
inline Vector3 log_rotation(const Quaternion& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Vector3 v = sign * q.vec();
  const double sine = v.norm();
  const double w = sign * q.w();
  if (sine < 1e-9) return 2.0 / w * v;
  return 2.0 * std::atan2(sine, w) / sine * v;
}

/// exp(phi + d) = exp(phi) exp(J d) for small d.
inline Matrix3 right_jacobian(const Vector3& phi) {
  const double square = phi.squaredNorm();
  double a = 0.5 - square / 24.0;
  double b = 1.0 / 6.0 - square / 120.0;
  constexpr double kSmall = 1e-5;  // rad^2: the series is good to 1e-13
  if (square > kSmall) {
    const double angle = std::sqrt(square);
    a = (1.0 - std::cos(angle)) / square;
    b = (angle - std::sin(angle)) / (square * angle);
  }
  const Matrix3 s = skew(phi);
  return Matrix3::Identity() - a * s + b * (s * s);
}

}  // namespace rosflight::autonomy::estimation
