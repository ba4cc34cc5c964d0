// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/math.hpp"

/// Attitude kinematics in double precision by closed forms, written apart from the code under test.
namespace rosflight::core::truth {

using Rates = std::array<double, 3>;

struct Attitude {
  double w{1}, x{0}, y{0}, z{0};

  /// Turns by a constant body rate for a time: q exp(w t / 2), exact.
  Attitude turned(const Rates& rate, double t) const {
    const double speed = std::hypot(rate[0], rate[1], rate[2]);
    const double c = std::cos(speed * t / 2);
    const double s = speed > 0 ? std::sin(speed * t / 2) / speed : t / 2;
    const double a = s * rate[0], b = s * rate[1], d = s * rate[2];
    return {w * c - x * a - y * b - z * d, w * a + x * c + y * d - z * b,
            w * b - x * d + y * c + z * a, w * d + x * b - y * a + z * c};
  }
  static Attitude from_euler(double roll, double pitch, double yaw) {
    return Attitude{}.turned({0, 0, 1}, yaw).turned({0, 1, 0}, pitch).turned({1, 0, 0}, roll);
  }
  /// Specific force at rest in this attitude [m/s^2]: minus gravity, in body axes.
  hal::Vec3 accel_at_rest() const {
    constexpr double kG = 9.80665;
    return {static_cast<float>(-kG * 2 * (x * z - w * y)),
            static_cast<float>(-kG * 2 * (y * z + w * x)),
            static_cast<float>(-kG * (1 - 2 * (x * x + y * y)))};
  }
  std::array<float, 4> floats() const {
    return {static_cast<float>(w), static_cast<float>(x), static_cast<float>(y),
            static_cast<float>(z)};
  }
  /// Angle between this attitude and an estimate [rad].
  double angle_to(const Quaternion& q) const {
    const double qw{q.w}, qx{q.x}, qy{q.y}, qz{q.z};
    // Vector part of conj(this) * q: well conditioned for small angles, unlike the scalar part.
    const double a = w * qx - x * qw - y * qz + z * qy;
    const double b = w * qy - y * qw - z * qx + x * qz;
    const double c = w * qz - z * qw - x * qy + y * qx;
    return 2 * std::asin(std::min(1.0, std::hypot(a, b, c)));
  }
};

}  // namespace rosflight::core::truth
