// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "firmware/core/elementary.hpp"
#include "firmware/hal/samples.hpp"

/// Small mathematics shared by the core: fixed-size vectors, quaternions, the air.
namespace rosflight::core {

using Vector3 = Eigen::Vector3f;
using Matrix3 = Eigen::Matrix3f;

inline constexpr float kPi = 3.14159265f;
inline constexpr float kRadPerDeg = 0.017453293f;
inline constexpr float kGravity_m_s2 = 9.80665f;  ///< Standard gravity, CGPM 1901.

inline Vector3 to_vector(const hal::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Unit quaternion, scalar first, Hamilton product; q_NB takes B coordinates to N.
struct Quaternion {
  float w{1.0f}, x{0.0f}, y{0.0f}, z{0.0f};
};

inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

inline float squared_norm(const Quaternion& q) {
  return q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
}

/// Inverse of a unit quaternion.
inline Quaternion conjugate(const Quaternion& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

/// Scaled to length 1 with w >= 0, so that one attitude has one quaternion.
inline Quaternion normalized(const Quaternion& q) {
  const float scale = (q.w < 0.0f ? -1.0f : 1.0f) / std::sqrt(squared_norm(q));
  return {q.w * scale, q.x * scale, q.y * scale, q.z * scale};
}

/// R(q) with v_N = R(q_NB) v_B.
inline Matrix3 rotation_matrix(const Quaternion& q) {
  Matrix3 R;
  R << 1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w), 2 * (q.x * q.z + q.y * q.w),
      2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.x * q.w),
      2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w), 1 - 2 * (q.x * q.x + q.y * q.y);
  return R;
}

/// Yaw-pitch-roll (z-y-x) angles [rad].
inline float roll_of(const Quaternion& q) {
  return atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y));
}
inline float pitch_of(const Quaternion& q) {
  const float s = 2 * (q.w * q.y - q.z * q.x);
  return asin(s > 1.0f ? 1.0f : (s < -1.0f ? -1.0f : s));
}
inline float yaw_of(const Quaternion& q) {
  return atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}

inline Quaternion quaternion_from_euler(float roll_rad, float pitch_rad, float yaw_rad) {
  const auto [sr, cr] = sin_cos(roll_rad / 2);
  const auto [sp, cp] = sin_cos(pitch_rad / 2);
  const auto [sy, cy] = sin_cos(yaw_rad / 2);
  return {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
          cr * cp * sy - sr * sp * cy};
}

/// Air of the standard atmosphere (below 11 km), as ROSflight computes it from static pressure p
/// [Pa]:
///     rho = 1.225 (p/101325)^0.809736894596450                 [kg/m^3]
///     h   = (1 - (p/101325)^0.190326730028458) 44318.1386038261  [m above sea level]
inline constexpr float kSeaLevelDensity_kg_m3 = 1.225f;
inline float air_density_kg_m3(float pressure_Pa) {
  return kSeaLevelDensity_kg_m3 * pow(pressure_Pa / 101325.0f, 0.809736895f);
}
inline float pressure_altitude_m(float pressure_Pa) {
  return (1.0f - pow(pressure_Pa / 101325.0f, 0.190326730f)) * 44318.1386f;
}

}  // namespace rosflight::core
