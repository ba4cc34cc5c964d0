// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/geodesy.hpp"

#include <cmath>

namespace rosflight::autonomy {
namespace {

constexpr double kSemiMajor_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kEccentricitySq = kFlattening * (2.0 - kFlattening);

}  // namespace

Vector3 ecef_of(const Geodetic& place) {
  const double lat = place.latitude_deg * kRadPerDeg;
  const double lon = place.longitude_deg * kRadPerDeg;
  const double s = std::sin(lat);
  const double n = kSemiMajor_m / std::sqrt(1.0 - kEccentricitySq * s * s);
  const double across = (n + place.altitude_m) * std::cos(lat);
  return {across * std::cos(lon), across * std::sin(lon),
          (n * (1.0 - kEccentricitySq) + place.altitude_m) * s};
}

Vector3 ned_of(const Geodetic& place, const Geodetic& origin) {
  const Vector3 d = ecef_of(place) - ecef_of(origin);
  const double lat = origin.latitude_deg * kRadPerDeg;
  const double lon = origin.longitude_deg * kRadPerDeg;
  const double outward = std::cos(lon) * d.x() + std::sin(lon) * d.y();
  return {std::cos(lat) * d.z() - std::sin(lat) * outward,
          std::cos(lon) * d.y() - std::sin(lon) * d.x(),
          -std::cos(lat) * outward - std::sin(lat) * d.z()};
}

}  // namespace rosflight::autonomy
