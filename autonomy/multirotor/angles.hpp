// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/multirotor/types.hpp"

namespace rosflight::autonomy::multirotor {

/// The attitude as the control loops need it, with one trigonometric call.
struct AttitudeView {
  double psi_rad{};
  double sin_psi{};
  double cos_psi{1.0};
  double cos_tilt{1.0};  ///< Body z against the vertical: cos(roll) cos(pitch).

  /// @param q_WB  normalised. Nose straight up or down: heading 0.
  explicit AttitudeView(const Quaternion& q_WB) {
    const double w = q_WB.w();
    const double x = q_WB.x();
    const double y = q_WB.y();
    const double z = q_WB.z();
    const double r00 = 1.0 - 2.0 * (y * y + z * z);
    const double r10 = 2.0 * (x * y + w * z);
    cos_tilt = 1.0 - 2.0 * (x * x + y * y);
    const double length = std::sqrt(r00 * r00 + r10 * r10);
    if (length > 1e-9) {  // nose straight up or down has no heading: north is as good as any
      sin_psi = r10 / length;
      cos_psi = r00 / length;
      psi_rad = std::atan2(r10, r00);
    }
  }
};

/// Attitude that points the thrust of a multirotor along a wanted specific force.
///
/// With f_v1 the force per mass in v1 (what is left of a commanded acceleration after gravity) the
/// body z axis is z = -f/|f| = (cos roll sin pitch, -sin roll, cos roll cos pitch), hence
///
///     roll = asin(f_y/|f|),   pitch = atan(f_x/f_z)      (f_z < 0: thrust up)        (1)
///
/// (1) is exact; the often seen pitch = -asin(f_x/|f|) is short of a cos(roll). Ferrin, Leishman,
/// Beard, McLain: Differential flatness based control of a rotorcraft for aggressive maneuvers,
/// IROS 2011.
struct ThrustDirection {
  double roll_rad{};
  double pitch_rad{};
  double specific_force_m_s2{};

  /// (1) for a force per mass in v1 [m/s^2]; level if it does not point up (f_z < 0) or is zero.
  static ThrustDirection of(double f_x, double f_y, double f_z) {
    const double length = std::sqrt(f_x * f_x + f_y * f_y + f_z * f_z);
    if (length < 1e-6 || f_z > -1e-6) return {0.0, 0.0, length};
    return {std::asin(f_y / length), std::atan(f_x / f_z), length};
  }
};

}  // namespace rosflight::autonomy::multirotor
