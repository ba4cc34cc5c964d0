// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "bench/passthrough/passthrough_flight.hpp"

namespace rosflight::bench::passthrough {
namespace {

TEST(Triangle, RisesFromZeroTurnsAtAQuarterAndRepeats) {
  constexpr double kPeriod_s = 4.0;
  EXPECT_DOUBLE_EQ(Triangle::at(0.0, kPeriod_s).value, 0.0);
  EXPECT_DOUBLE_EQ(Triangle::at(0.5, kPeriod_s).value, 0.5);
  EXPECT_DOUBLE_EQ(Triangle::at(0.5, kPeriod_s).slope_1_s, 1.0);
  EXPECT_DOUBLE_EQ(Triangle::at(1.0, kPeriod_s).value, 1.0);
  EXPECT_DOUBLE_EQ(Triangle::at(1.5, kPeriod_s).slope_1_s, -1.0);
  EXPECT_DOUBLE_EQ(Triangle::at(3.0, kPeriod_s).value, -1.0);
  EXPECT_DOUBLE_EQ(Triangle::at(8.5, kPeriod_s).value, 0.5);
}

/// A triangle of 10 degrees that is followed 20 ms late.
std::vector<Row> late_rows() {
  constexpr double kStep_s = 0.0025, kPeriod_s = 4.0, kLate_s = 0.02, kAmplitude_deg = 10.0;
  std::vector<Row> rows;
  for (int k = 0; k < 3200; ++k) {
    const double t_s = kStep_s * k;
    rows.push_back({t_s, kAmplitude_deg * Triangle::at(t_s, kPeriod_s).value,
                    kAmplitude_deg * Triangle::at(t_s + kPeriod_s - kLate_s, kPeriod_s).value,
                    0.0});
  }
  return rows;
}

TEST(Judge, FindsTheLagAndTheErrorWithAndWithoutIt) {
  const Following found = judge(late_rows());
  EXPECT_NEAR(found.lag_s, 0.02, 1e-9);
  EXPECT_NEAR(found.max_deg, 0.2, 1e-6) << "slope of 10 deg/s times 20 ms";
  // The error is 0.2 deg but for the 20 ms behind a corner, in which it goes through zero.
  EXPECT_NEAR(found.rms_deg, 0.2, 0.002);
  EXPECT_NEAR(found.rms_without_lag_deg, 0.0, 1e-6);
}

// The accelerometer of a multirotor shows no lateral force, so the firmware's filter, with a gain of 0.5/s, is drawn towards
// level: its error e obeys e' = -k e + 0.5/s roll. Its share of a roll of 0.25 Hz is 0.5/|k + 1.571 i|. The triangle of
// 11.46 deg has an rms of 6.62 deg.
constexpr double kTriangle_rms_deg = 6.62;

TEST(Passthrough, RollFollowsTheTriangleOnCommandsOfTheCompanionAlone) {
  PassthroughPlan plan;
  plan.duration_s = 8.0;
  const PassthroughResult flown = fly_passthrough(plan);
  const Following found = judge(flown.rows);
  EXPECT_NEAR(flown.attitudes_hz, 400.0, 2.0);
  EXPECT_NEAR(flown.commands_hz, flown.attitudes_hz, 0.5) << "one for each attitude";
  EXPECT_EQ(flown.dropped, 0U);
  EXPECT_EQ(flown.rows.size(), 3200U);
  EXPECT_GT(flown.height_min_m, 4.0);
  EXPECT_LT(flown.height_max_m, 6.0);
  // The attitude of the companion draws it to the true one with 1.5/s more: k = 2/s.
  constexpr double kShare = 0.197, kLoop_deg = 0.5;
  EXPECT_LT(found.rms_deg, std::hypot(kShare * kTriangle_rms_deg, kLoop_deg));
}

TEST(Passthrough, OnTheFirmwaresOwnAttitudeTheLoopsCloseAndItsErrorIsInTheTrueRoll) {
  PassthroughPlan plan;
  plan.shares_attitude = false;
  const Following found = judge(fly_passthrough(plan).rows);
  constexpr double kShare = 0.303;  // k = 0.5/s
  EXPECT_NEAR(found.rms_deg, kShare * kTriangle_rms_deg, 0.3);
  EXPECT_LT(found.estimated_rms_deg, 0.5);
}

TEST(Passthrough, AWaveAboveTheBandwidthIsNotFollowed) {
  PassthroughPlan fast;
  fast.duration_s = 4.0;
  fast.period_s = 0.4;  // 15.7 rad/s; the loop has 12
  EXPECT_GT(judge(fly_passthrough(fast).rows).rms_deg, 2.0);
}

}  // namespace
}  // namespace rosflight::bench::passthrough
