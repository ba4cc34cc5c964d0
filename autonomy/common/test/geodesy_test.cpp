// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/geodesy.hpp"

#include <gtest/gtest.h>

namespace rosflight::autonomy {
namespace {

void expect_near(const Vector3& got, const Vector3& want, double tolerance_m) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got[i], want[i], tolerance_m) << "component " << i;
}

// Numbers from PROJ 9.5.1 (cart and topocentric, ellipsoid WGS84), printed to a micrometre.
constexpr double kPrinted_m = 1e-6;

TEST(Geodesy, EarthCentredCoordinatesMatchProj) {
  expect_near(ecef_of({40.2672, -111.6357, 1387.0}),
              {-1797299.090389, -4531208.570626, 4101565.392379}, kPrinted_m);
  expect_near(ecef_of({-33.8568, 151.2153, 4.0}),
              {-4646971.548644, 2553078.519657, -3533269.355967}, kPrinted_m);
  expect_near(ecef_of({90.0, 0.0, 0.0}), {0.0, 0.0, 6356752.314245}, kPrinted_m);
  expect_near(ecef_of({0.0, 0.0, 0.0}), {6378137.0, 0.0, 0.0}, kPrinted_m);
}

TEST(Geodesy, LocalCoordinatesMatchProj) {
  const Geodetic provo{40.2672, -111.6357, 1387.0};
  const Geodetic sydney{-33.8568, 151.2153, 4.0};
  expect_near(ned_of({40.2682, -111.6347, 1397.0}, provo), {111.064644, 85.077434, -9.998464},
              kPrinted_m);
  expect_near(ned_of({40.3672, -111.5357, 1387.0}, provo), {11111.280354, 8495.308927, 15.349100},
              kPrinted_m);
  expect_near(ned_of({-33.85, 151.22, 50.0}, sydney), {754.250231, 434.973625, -45.940426},
              kPrinted_m);
}

// Weak point 25: positions in single precision moved by 0.4 to 0.65 m.
TEST(Geodesy, AMillimetreIsSeen) {
  const Geodetic origin{40.2672, -111.6357, 1387.0};
  const double millimetre_deg = 1e-3 / 111132.0;
  const Vector3 p = ned_of(
      {origin.latitude_deg + millimetre_deg, origin.longitude_deg, origin.altitude_m}, origin);
  EXPECT_NEAR(p.x(), 1e-3, 1e-5);  // the length of a degree of latitude varies by 0.5 %
  expect_near(ned_of(origin, origin), Vector3::Zero(), 0.0);
}

}  // namespace
}  // namespace rosflight::autonomy
