// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

namespace rosflight::autonomy::fixedwing {

/// Radius of a coordinated turn [m]:
///
///     R = Vg^2/(g tan phi)                                                                  (1)
///
/// A circle over ground in wind needs it for the fastest point, Vg = V + W. Beard & McLain, Small
/// Unmanned Aircraft, 2012, sec. 9.2.
inline double closest_turn_radius(double ground_speed_m_s, double roll_rad, double gravity_m_s2) {
  return ground_speed_m_s * ground_speed_m_s / (gravity_m_s2 * std::tan(roll_rad));
}

}  // namespace rosflight::autonomy::fixedwing
