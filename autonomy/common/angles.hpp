// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/types.hpp"
#include "base/angles.hpp"

namespace rosflight::autonomy {

using base::wrap_angle;

struct RollPitch {
  double roll_rad{};
  double pitch_rad{};

  /// Roll and pitch of the 3-2-1 Euler angles of an attitude [rad]; pitch within +-pi/2, also when
  /// rounding takes its sine past 1.
  static RollPitch of(const Quaternion& q_WB) {
    const double w = q_WB.w();
    const double x = q_WB.x();
    const double y = q_WB.y();
    const double z = q_WB.z();
    const double sin_pitch = 2.0 * (w * y - x * z);
    return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            std::asin(std::fmin(1.0, std::fmax(-1.0, sin_pitch)))};
  }
};

/// Yaw of the 3-2-1 Euler angles of an attitude: where the nose points [rad], 0 north, pi/2 east.
inline double heading_of(const Quaternion& q_WB) {
  const Quaternion& q = q_WB;
  return std::atan2(2.0 * (q.x() * q.y() + q.w() * q.z()),
                    1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
}

}  // namespace rosflight::autonomy
