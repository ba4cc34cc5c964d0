// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy {

/// The same angle in (-pi, pi]; exact for |angle| <= pi.
inline double wrap_angle(double angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

struct RollPitch {
  double roll_rad{};
  double pitch_rad{};

  static RollPitch of(const Quaternion& q_NB) {
    const double w = q_NB.w();
    const double x = q_NB.x();
    const double y = q_NB.y();
    const double z = q_NB.z();
    const double sin_pitch = 2.0 * (w * y - x * z);
    return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            std::asin(std::fmin(1.0, std::fmax(-1.0, sin_pitch)))};
  }
};

}  // namespace rosflight::autonomy
