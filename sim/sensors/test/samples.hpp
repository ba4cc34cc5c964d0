// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "sim/environment/environment.hpp"
#include "sim/types.hpp"

/// Worlds for the instruments to look at.
namespace rosflight::sim::sensors {

inline constexpr double kTestGravity = 9.80665;

/// Level, at rest, on the ground at time t.
inline Truth at_rest(Time t = Time{0}) {
  Truth truth;
  truth.time = t;
  truth.specific_force_B = {0.0, 0.0, -kTestGravity};
  return truth;
}

inline Quaternion turned(double angle_rad, const Vector3& axis) {
  return Quaternion(Eigen::AngleAxisd(angle_rad, axis));
}

/// Provo, Utah, where the ROSflight 2.x simulator starts, with its magnetic field.
inline EnvironmentParameters test_place() {
  EnvironmentParameters place;
  place.origin = {.latitude_deg = 40.2463724, .longitude_deg = -111.6474138, .altitude_m = 1387.0};
  place.start_unix_s = 1'780'315'200;  // 2026-06-01T12:00:00Z
  place.gravity_m_s2 = kTestGravity;
  place.magnetic_field_W_T = {2.08399e-5, 3.91717e-6, 4.60706e-5};
  return place;
}

}  // namespace rosflight::sim::sensors
