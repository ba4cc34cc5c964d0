// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/types.hpp"

namespace rosflight::sim {

/// A place by WGS-84 latitude, longitude and height. Heights above mean sea level are used as
/// heights above the ellipsoid; the geoid's up to 107 m change distances by less than 2e-5 and drop
/// out of height differences.
struct GeodeticPosition {
  double latitude_deg{};
  double longitude_deg{};  ///< In (-180, 180].
  double height_m{};
};

/// Earth-centred, earth-fixed Cartesian coordinates [m]: x to 0 N 0 E, z to the north pole.
/// WGS-84 ellipsoid: a = 6378137 m, f = 1/298.257223563 (NIMA TR8350.2, 3rd ed., table 3.1).
Vector3 to_ecef(const GeodeticPosition& position);

/// Inverse by B. R. Bowring's iteration ("The accuracy of geodetic latitude and height equations",
/// Survey Review 28, 1985); error below 1e-8 m from 10 km under to 1000 km over the ellipsoid.
GeodeticPosition to_geodetic(const Vector3& ecef);

/// The simulation's inertial frame N: north, east, down at a point of the ellipsoid, a flat tangent
/// frame carried exactly through ECEF (at 10 km distance the ellipsoid lies 7.8 m below the plane).
class LocalFrame {
 public:
  explicit LocalFrame(const GeodeticPosition& origin);

  Vector3 to_local(const GeodeticPosition& position) const;
  GeodeticPosition to_geodetic(const Vector3& p_N) const;
  const GeodeticPosition& origin() const { return origin_; }

 private:
  GeodeticPosition origin_;
  Vector3 origin_ecef_;
  Eigen::Matrix3d R_NE_;  ///< Takes ECEF coordinates to N.
};

}  // namespace rosflight::sim
