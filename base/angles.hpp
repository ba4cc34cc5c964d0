// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "base/constants.hpp"

namespace rosflight::base {

/// The same angle in (-pi, pi]; exact for |angle| <= pi.
inline double wrap_angle(double angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

}  // namespace rosflight::base
