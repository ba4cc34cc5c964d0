// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/geodesy.hpp"

#include <cmath>

#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

constexpr double kMajorAxis_m = 6378137.0;
constexpr double kFlattening = 1.0 / 298.257223563;
constexpr double kMinorAxis_m = kMajorAxis_m * (1.0 - kFlattening);
constexpr double kEccentricitySq = kFlattening * (2.0 - kFlattening);
constexpr double kSecondEccentricitySq = kEccentricitySq / (1.0 - kEccentricitySq);
constexpr double kRadPerDeg = 3.141592653589793 / 180.0;

}  // namespace

Vector3 to_ecef(const GeodeticPosition& position) {
  const auto lat = portable::sin_cos(position.latitude_deg * kRadPerDeg);
  const auto lon = portable::sin_cos(position.longitude_deg * kRadPerDeg);
  const double normal = kMajorAxis_m / std::sqrt(1.0 - kEccentricitySq * lat.sin * lat.sin);
  const double across = (normal + position.height_m) * lat.cos;
  return {across * lon.cos, across * lon.sin,
          (normal * (1.0 - kEccentricitySq) + position.height_m) * lat.sin};
}

GeodeticPosition to_geodetic(const Vector3& ecef) {
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
    phi_y = ecef.z() + kSecondEccentricitySq * kMinorAxis_m * s * s * s;
    phi_x = across - kEccentricitySq * kMajorAxis_m * c * c * c;
    beta_x = phi_x;
    beta_y = (1.0 - kFlattening) * phi_y;
  }
  const double norm = std::sqrt(phi_x * phi_x + phi_y * phi_y);
  const double sin_phi = phi_y / norm;
  const double cos_phi = phi_x / norm;
  GeodeticPosition position;
  position.latitude_deg = portable::atan2(phi_y, phi_x) / kRadPerDeg;
  position.longitude_deg = portable::atan2(ecef.y(), ecef.x()) / kRadPerDeg;
  position.height_m = across * cos_phi + ecef.z() * sin_phi -
                      kMajorAxis_m * std::sqrt(1.0 - kEccentricitySq * sin_phi * sin_phi);
  return position;
}

LocalFrame::LocalFrame(const GeodeticPosition& origin)
    : origin_{origin}, origin_ecef_{to_ecef(origin)} {
  const auto lat = portable::sin_cos(origin.latitude_deg * kRadPerDeg);
  const auto lon = portable::sin_cos(origin.longitude_deg * kRadPerDeg);
  R_NE_ << -lat.sin * lon.cos, -lat.sin * lon.sin, lat.cos,  //
      -lon.sin, lon.cos, 0.0,                                //
      -lat.cos * lon.cos, -lat.cos * lon.sin, -lat.sin;
}

Vector3 LocalFrame::to_local(const GeodeticPosition& position) const {
  return R_NE_ * (to_ecef(position) - origin_ecef_);
}

GeodeticPosition LocalFrame::to_geodetic(const Vector3& p_N) const {
  return sim::to_geodetic(origin_ecef_ + R_NE_.transpose() * p_N);
}

}  // namespace rosflight::sim
