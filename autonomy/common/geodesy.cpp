// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/geodesy.hpp"

#include <cmath>

namespace rosflight::autonomy {
namespace {

struct SinCos {
  double sin;
  double cos;
};

}  // namespace

Vector3 ecef_of(const Geodetic& place) {
  return base::to_ecef(
      place, [](double angle_rad) { return SinCos{std::sin(angle_rad), std::cos(angle_rad)}; });
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
