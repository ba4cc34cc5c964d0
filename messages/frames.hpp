// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/types.hpp"

/// From the frames of ROSflight to those that ROS tools draw in (REP-103, REP-105):
///
///     map, odom: x east, y north, z up              NED:  x north, y east, z down
///     base_link: x forward, y left, z up            body: x forward, y right, z down
///
/// `map` and `odom` coincide: their origin is that of the vehicle file, as that of NED.
namespace rosflight::messages {

inline constexpr double kHalfSqrt2 = 0.7071067811865476;

/// Takes body coordinates to base_link, and back.
inline const sim::Quaternion kFluFromFrd{0.0, 1.0, 0.0, 0.0};
/// Takes coordinates of NED to the map, and back.
inline const sim::Quaternion kEnuFromNed{0.0, kHalfSqrt2, kHalfSqrt2, 0.0};

/// The same as kEnuFromNed, without rounding.
inline sim::Vector3 enu(const sim::Vector3& ned) {
  return {ned.y(), ned.x(), -ned.z()};
}

/// The same as kFluFromFrd.
inline sim::Vector3 flu(const sim::Vector3& frd) {
  return {frd.x(), -frd.y(), -frd.z()};
}

/// Takes base_link coordinates to the map. @param q_WB  body to NED.
inline sim::Quaternion q_map_base(const sim::Quaternion& q_WB) {
  return kEnuFromNed * q_WB * kFluFromFrd.conjugate();
}

}  // namespace rosflight::messages
