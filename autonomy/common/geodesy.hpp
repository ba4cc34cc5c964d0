// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/types.hpp"

namespace rosflight::autonomy {

/// A place on WGS-84; altitude above the ellipsoid, or above sea level wherever only differences
/// count.
struct Geodetic {
  double latitude_deg{};
  double longitude_deg{};
  double altitude_m{};
};

/// Earth-centred, earth-fixed coordinates: X = (N + h) cos lat cos lon, Y = (N + h) cos lat sin
/// lon, Z = (N (1 - e^2) + h) sin lat, N = a/sqrt(1 - e^2 sin^2 lat). WGS-84 as in NGA.STND.0036,
/// 2014.
Vector3 ecef_of(const Geodetic& place);

/// North, east, down from `origin` in the plane that touches there: exact up to double rounding
/// (nm), also in that the earth falls away below the plane by d^2/(2 R), 8 cm at 1 km.
Vector3 ned_of(const Geodetic& place, const Geodetic& origin);

}  // namespace rosflight::autonomy
