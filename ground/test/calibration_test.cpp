// SPDX-License-Identifier: BSD-3-Clause
#include "ground/calibration.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rosflight::ground {
namespace {

constexpr double kGravity_m_s2 = 9.80665;

/// Two samples about each mean: their standard deviation is sqrt(2) times `off`.
SensorStatistics at(const std::array<double, 3>& accel_m_s2,
                    const std::array<double, 3>& gyro_rad_s, double off) {
  SensorStatistics s;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double side : {-1.0, 1.0}) {
      s.accel_m_s2[i].add(accel_m_s2[i] + side * off);
      s.gyro_rad_s[i].add(gyro_rad_s[i] + side * off);
    }
  }
  return s;
}

TEST(Statistics, MeanAndDeviationOfAKnownSeries) {
  Statistics s;
  EXPECT_EQ(s.deviation(), 0.0);
  for (const double x :
       {1e6 + 2.0, 1e6 + 4.0, 1e6 + 4.0, 1e6 + 4.0, 1e6 + 5.0, 1e6 + 5.0, 1e6 + 7.0, 1e6 + 9.0}) {
    s.add(x);
  }
  EXPECT_DOUBLE_EQ(s.mean(), 1e6 + 5.0);
  EXPECT_NEAR(s.deviation(), std::sqrt(32.0 / 7.0), 1e-9);  // squares 9 1 1 1 0 0 4 16
  EXPECT_EQ(s.count(), 8U);
}

TEST(Figure, IsGoodUpToItsLimitOnBothSidesAndNeverWithoutANumber) {
  EXPECT_TRUE((Figure{"tilt", -5.0, 5.0, "deg"}).good());
  EXPECT_FALSE((Figure{"tilt", -5.1, 5.0, "deg"}).good());
  EXPECT_FALSE((Figure{"tilt", std::numeric_limits<double>::quiet_NaN(), 5.0, "deg"}).good());
  EXPECT_EQ((Figure{"tilt", 7.125, 5.0, "deg"}).text(), "tilt 7.12 deg, limit 5 deg");
}

TEST(GyroFigures, MotionCountsBeforeTheOffsetLeftAfterwards) {
  const SensorStatistics biased = at({}, {0.2, 0.0, 0.0}, 0.01);
  EXPECT_EQ(first_bad(gyro_figures(biased, false)), nullptr);  // an offset is what it is for
  const auto after = gyro_figures(biased, true);
  ASSERT_NE(first_bad(after), nullptr);
  EXPECT_EQ(first_bad(after)->name, "offset left");
  const auto moving = gyro_figures(at({}, {}, 0.1), false);
  ASSERT_NE(first_bad(moving), nullptr);
  EXPECT_NEAR(first_bad(moving)->value, 0.1 * std::sqrt(2.0), 1e-12);
}

TEST(AccelFigures, TiltIsThatOfTheForceWithoutTheOldOffset) {
  const double six_deg = 6.0 * 3.14159265358979 / 180.0;
  const std::array<double, 3> tilted{kGravity_m_s2 * std::sin(six_deg), 0.0,
                                     -kGravity_m_s2 * std::cos(six_deg)};
  const auto refused = accel_figures(at(tilted, {}, 0.01), {}, false);
  ASSERT_NE(first_bad(refused), nullptr);
  EXPECT_EQ(first_bad(refused)->name, "tilt");
  EXPECT_NEAR(first_bad(refused)->value, 6.0, 1e-9);
  // The old offset hides it: measured = true - offset.
  const auto hidden =
      accel_figures(at({0.0, 0.0, tilted[2]}, {}, 0.01), {tilted[0], 0.0, 0.0}, false);
  ASSERT_NE(first_bad(hidden), nullptr);
  EXPECT_NEAR(first_bad(hidden)->value, 6.0, 1e-9);
}

TEST(AccelFigures, AfterwardsTheForceIsGravity) {
  EXPECT_EQ(first_bad(accel_figures(at({0.0, 0.0, -kGravity_m_s2}, {}, 0.01), {}, true)), nullptr);
  const auto weak = accel_figures(at({0.0, 0.0, -9.6}, {}, 0.01), {}, true);
  ASSERT_NE(first_bad(weak), nullptr);
  EXPECT_EQ(first_bad(weak)->name, "residual against g");
  const auto upside_down = accel_figures(at({0.0, 0.0, kGravity_m_s2}, {}, 0.01), {}, false);
  ASSERT_NE(first_bad(upside_down), nullptr);
  EXPECT_NEAR(first_bad(upside_down)->value, 180.0, 1e-9);
}

TEST(PressureFigures, NoiseAndOffset) {
  SensorStatistics s;
  for (const double x : {-3.0, 3.0}) {
    s.pressure_Pa.add(101325.0 + 2.0 * x);
    s.diff_pressure_Pa.add(5.0 + x);
  }
  ASSERT_NE(first_bad(baro_figures(s)), nullptr);
  EXPECT_EQ(first_bad(airspeed_figures(s, false)), nullptr);
  EXPECT_EQ(first_bad(airspeed_figures(s, true))->name, "offset left");
}

}  // namespace
}  // namespace rosflight::ground
