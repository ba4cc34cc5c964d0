// SPDX-License-Identifier: BSD-3-Clause
#include "base/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/angles.hpp"
#include "base/atmosphere.hpp"
#include "base/geodesy.hpp"

namespace rosflight::base {
namespace {

// Bit by bit: the values that stood in the tree before each was written once.
static_assert(kPi == std::numbers::pi);
static_assert(kRadPerDeg == 0.017453292519943295 && kDegPerRad == 57.29577951308232);
static_assert(static_cast<float>(kPi) == 3.14159265f &&
              static_cast<float>(kPi) == std::numbers::pi_v<float>);
static_assert(static_cast<float>(kRadPerDeg) == 0.017453293f);
static_assert(static_cast<float>(kStandardGravity_m_s2) == 9.80665f);
static_assert(static_cast<float>(kSeaLevelPressure_Pa) == 101325.0f);
static_assert(static_cast<float>(kSeaLevelDensity_kg_m3) == 1.225f);
static_assert(static_cast<float>(kRosflightTroposphere.density_exponent) == 0.809736895f);
static_assert(static_cast<float>(kRosflightTroposphere.altitude_exponent) == 0.190326730f);
static_assert(static_cast<float>(kRosflightTroposphere.scale_m) == 44318.1386f);

TEST(Constants, SixDigitsOfTheTroposphereFollowFromTheStandard) {
  constexpr double kLapse_K_m = -kAtmosphereLayers[0].lapse_K_m;
  constexpr double kExponent = kAirGasConstant_J_kg_K * kLapse_K_m / kStandardGravity_m_s2;
  EXPECT_NEAR(kTroposphere.scale_m, kSeaLevelTemperature_K / kLapse_K_m, 0.005);
  EXPECT_NEAR(kTroposphere.altitude_exponent, kExponent, 5e-7);
  EXPECT_NEAR(kTroposphere.density_exponent, 1.0 - kExponent, 5e-7);
  EXPECT_NEAR(kTroposphere.pressure_exponent, 1.0 / kExponent, 5e-6);
  EXPECT_NEAR(kSeaLevelDensity_kg_m3,
              kSeaLevelPressure_Pa / (kAirGasConstant_J_kg_K * kSeaLevelTemperature_K), 5e-4);
}

TEST(Constants, EllipsoidAgreesWithPrintedDerivedValues) {  // NGA.STND.0036, table 3.5
  EXPECT_NEAR(wgs84::kSemiMinorAxis_m, 6356752.3142, 5e-5);
  EXPECT_NEAR(wgs84::kEccentricitySq, 6.694379990141e-3, 5e-16);
  EXPECT_NEAR(wgs84::kSecondEccentricitySq, 6.739496742276e-3, 5e-16);
}

TEST(Angles, WrapIsExactInsideAndNeverMinusPi) {
  for (const double angle_rad : {0.0, 0.1, -3.1, kPi, std::nextafter(-kPi, 0.0)}) {
    EXPECT_EQ(wrap_angle(angle_rad), angle_rad);
  }
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_EQ(wrap_angle(3.0 * kPi), kPi);
  EXPECT_NEAR(wrap_angle(100.0), 100.0 - 32.0 * kPi, 1e-14);
}

TEST(Geodesy, CornersOfTheEllipsoid) {
  struct SineCosine {
    double sin, cos;
  };
  const auto sin_cos = [](double x) { return SineCosine{std::sin(x), std::cos(x)}; };
  EXPECT_NEAR((to_ecef({0.0, 90.0, 100.0}, sin_cos) - Eigen::Vector3d(0.0, 6378237.0, 0.0)).norm(),
              0.0, 1e-9);
  EXPECT_NEAR(
      (to_ecef({-90.0, 0.0, 0.0}, sin_cos) - Eigen::Vector3d(0.0, 0.0, -6356752.3142)).norm(), 0.0,
      5e-5);
}

}  // namespace
}  // namespace rosflight::base
