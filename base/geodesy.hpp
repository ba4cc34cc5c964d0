// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "base/constants.hpp"

namespace rosflight::base {

/// A position on the WGS-84 ellipsoid. Altitudes above mean sea level are used as altitudes above
/// the ellipsoid; the geoid's up to 107 m change distances by less than 2e-5 and drop out of
/// differences.
struct Geodetic {
  double latitude_deg{};
  double longitude_deg{};  ///< In (-180, 180].
  double altitude_m{};
};

/// Earth-centred, earth-fixed Cartesian coordinates [m]: x to 0 N 0 E, z to the north pole.
///
///     x = (N + h) cos lat cos lon
///     y = (N + h) cos lat sin lon
///     z = (N (1 - e^2) + h) sin lat,   N = a / sqrt(1 - e^2 sin^2 lat)
///
/// @param sin_cos  Returns sine and cosine of an angle [rad] as members `sin` and `cos`. The
///                 simulation passes its portable functions, autonomy those of the C library.
template <class SinCos>
Eigen::Vector3d to_ecef(const Geodetic& position, SinCos sin_cos) {
  const auto lat = sin_cos(position.latitude_deg * kRadPerDeg);
  const auto lon = sin_cos(position.longitude_deg * kRadPerDeg);
  const double normal =
      wgs84::kSemiMajorAxis_m / std::sqrt(1.0 - wgs84::kEccentricitySq * lat.sin * lat.sin);
  const double across = (normal + position.altitude_m) * lat.cos;
  return {across * lon.cos, across * lon.sin,
          (normal * (1.0 - wgs84::kEccentricitySq) + position.altitude_m) * lat.sin};
}

}  // namespace rosflight::base
