// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "base/atmosphere.hpp"
#include "base/constants.hpp"
#include "base/eigen.hpp"
#include "firmware/core/elementary.hpp"
#include "firmware/hal/samples.hpp"

/// Small mathematics shared by the core: fixed-size vectors, quaternions, the air.
namespace rosflight::core {

using Vector3 = Eigen::Vector3f;
using Matrix3 = Eigen::Matrix3f;

inline constexpr auto kPi = static_cast<float>(base::kPi);
inline constexpr auto kRadPerDeg = static_cast<float>(base::kRadPerDeg);
inline constexpr auto kGravity_m_s2 = static_cast<float>(base::kStandardGravity_m_s2);

/// The same three numbers as an Eigen vector.
inline Vector3 to_vector(const hal::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Unit quaternion, scalar first, Hamilton product; q_WB takes B coordinates to W.
struct Quaternion {
  float w{1.0f}, x{0.0f}, y{0.0f}, z{0.0f};
};

inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// Sum of the squares of the four components.
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

/// R(q) with v_W = R(q_WB) v_B.
inline Matrix3 rotation_matrix(const Quaternion& q) {
  Matrix3 R;
  R << 1 - 2 * (q.y * q.y + q.z * q.z), 2 * (q.x * q.y - q.z * q.w), 2 * (q.x * q.z + q.y * q.w),
      2 * (q.x * q.y + q.z * q.w), 1 - 2 * (q.x * q.x + q.z * q.z), 2 * (q.y * q.z - q.x * q.w),
      2 * (q.x * q.z - q.y * q.w), 2 * (q.y * q.z + q.x * q.w), 1 - 2 * (q.x * q.x + q.y * q.y);
  return R;
}

/// Roll of the yaw-pitch-roll (z-y-x) angles [rad], -pi..pi.
inline float roll_of(const Quaternion& q) {
  return atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y));
}
/// Pitch of the same angles [rad], -pi/2..pi/2.
inline float pitch_of(const Quaternion& q) {
  const float s = 2 * (q.w * q.y - q.z * q.x);
  return asin(s > 1.0f ? 1.0f : (s < -1.0f ? -1.0f : s));
}
/// Yaw of the same angles [rad], -pi..pi.
inline float yaw_of(const Quaternion& q) {
  return atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
}

/// The attitude of yaw-pitch-roll (z-y-x) angles [rad].
inline Quaternion quaternion_from_euler(float roll_rad, float pitch_rad, float yaw_rad) {
  const auto [sr, cr] = sin_cos(roll_rad / 2);
  const auto [sp, cp] = sin_cos(pitch_rad / 2);
  const auto [sy, cy] = sin_cos(yaw_rad / 2);
  return {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
          cr * cp * sy - sr * sp * cy};
}

/// Air of the standard atmosphere (below 11 km), as ROSflight computes it from static pressure p
/// [Pa]: equations (1) and (2) of base/atmosphere.hpp with the numbers of kRosflightTroposphere.
inline constexpr auto kSeaLevelPressure_Pa = static_cast<float>(base::kSeaLevelPressure_Pa);
inline constexpr auto kSeaLevelDensity_kg_m3 = static_cast<float>(base::kSeaLevelDensity_kg_m3);
/// Density by (2) [kg/m^3].
inline float air_density_kg_m3(float pressure_Pa) {
  constexpr auto kExponent = static_cast<float>(base::kRosflightTroposphere.density_exponent);
  return kSeaLevelDensity_kg_m3 * pow(pressure_Pa / kSeaLevelPressure_Pa, kExponent);
}
/// Altitude above mean sea level by (1) [m].
inline float pressure_altitude_m(float pressure_Pa) {
  constexpr auto kExponent = static_cast<float>(base::kRosflightTroposphere.altitude_exponent);
  constexpr auto kScale_m = static_cast<float>(base::kRosflightTroposphere.scale_m);
  return (1.0f - pow(pressure_Pa / kSeaLevelPressure_Pa, kExponent)) * kScale_m;
}

}  // namespace rosflight::core
