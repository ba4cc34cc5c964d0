// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "base/geodesy.hpp"
#include "sim/types.hpp"

namespace rosflight::sim {

using base::Geodetic;

/// base::to_ecef() with the portable sine and cosine.
Vector3 to_ecef(const Geodetic& position);

/// Inverse by B. R. Bowring's iteration ("The accuracy of geodetic latitude and height equations",
/// Survey Review 28, 1985); error below 1e-8 m from 10 km under to 1000 km over the ellipsoid.
Geodetic to_geodetic(const Vector3& ecef);

/// The simulation's world frame W: north, east, down at a point of the ellipsoid, a flat tangent
/// frame carried exactly through ECEF (at 10 km distance the ellipsoid lies 7.8 m below the plane).
class LocalFrame {
 public:
  /// @param origin  the point p_W = 0.
  explicit LocalFrame(const Geodetic& origin);

  /// p_W of a position [m].
  Vector3 to_local(const Geodetic& position) const;
  /// The position at p_W [m].
  Geodetic to_geodetic(const Vector3& p_W) const;
  const Geodetic& origin() const { return origin_; }

 private:
  Geodetic origin_;
  Vector3 origin_ecef_;
  Eigen::Matrix3d R_NE_;  ///< Takes ECEF coordinates to W.
};

}  // namespace rosflight::sim
