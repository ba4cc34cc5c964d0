// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/geodesy.hpp"

#include <cmath>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

using base::kRadPerDeg;
using namespace base::wgs84;

}  // namespace

Vector3 to_ecef(const Geodetic& position) {
  return base::to_ecef(position, portable::sin_cos);
}

Geodetic to_geodetic(const Vector3& ecef) {
  const double across = std::sqrt(ecef.x() * ecef.x() + ecef.y() * ecef.y());
  // Reduced latitude beta as a unit vector, latitude phi as an unnormalised one.
  double beta_x = across * (1.0 - kFlattening);
  double beta_y = ecef.z();
  double phi_x = 1.0;
  double phi_y = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double norm = std::sqrt(beta_x * beta_x + beta_y * beta_y);
    const double c = norm == 0.0 ? 1.0 : beta_x / norm;
    const double s = norm == 0.0 ? 0.0 : beta_y / norm;
    phi_y = ecef.z() + kSecondEccentricitySq * kSemiMinorAxis_m * s * s * s;
    phi_x = across - kEccentricitySq * kSemiMajorAxis_m * c * c * c;
    beta_x = phi_x;
    beta_y = (1.0 - kFlattening) * phi_y;
  }
  const double norm = std::sqrt(phi_x * phi_x + phi_y * phi_y);
  const double sin_phi = phi_y / norm;
  const double cos_phi = phi_x / norm;
  Geodetic position;
  position.latitude_deg = portable::atan2(phi_y, phi_x) / kRadPerDeg;
  position.longitude_deg = portable::atan2(ecef.y(), ecef.x()) / kRadPerDeg;
  position.altitude_m = across * cos_phi + ecef.z() * sin_phi -
                        kSemiMajorAxis_m * std::sqrt(1.0 - kEccentricitySq * sin_phi * sin_phi);
  return position;
}

LocalFrame::LocalFrame(const Geodetic& origin) : origin_{origin}, origin_ecef_{to_ecef(origin)} {
  const auto lat = portable::sin_cos(origin.latitude_deg * kRadPerDeg);
  const auto lon = portable::sin_cos(origin.longitude_deg * kRadPerDeg);
  R_NE_ << -lat.sin * lon.cos, -lat.sin * lon.sin, lat.cos,  //
      -lon.sin, lon.cos, 0.0,                                //
      -lat.cos * lon.cos, -lat.cos * lon.sin, -lat.sin;
}

Vector3 LocalFrame::to_local(const Geodetic& position) const {
  return R_NE_ * (to_ecef(position) - origin_ecef_);
}

Geodetic LocalFrame::to_geodetic(const Vector3& p_W) const {
  return sim::to_geodetic(origin_ecef_ + R_NE_.transpose() * p_W);
}

}  // namespace rosflight::sim
