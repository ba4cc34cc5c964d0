// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/figure_eight.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kRadius_m = 20.0;
constexpr double kSpeed_m_s = 8.0;

FigureEightLeg eight(int turns = 1, double course_rad = 0.0) {
  Trajectory start;
  start.p_W = {5.0, -3.0, -10.0};
  start.psi_rad = 0.7;
  return {start, kRadius_m, turns, course_rad, kSpeed_m_s, 3.0};
}

TEST(FigureEight, BeginsAndEndsAtRestInItsCrossing) {
  const FigureEightLeg leg = eight(2);
  for (const double t : {-1.0, 0.0, leg.duration_s(), leg.duration_s() + 1.0}) {
    const Trajectory at = leg.sample(t);
    EXPECT_EQ(at.p_W, Vector3(5.0, -3.0, -10.0));
    EXPECT_TRUE(at.v_W.isZero(0.0) && at.a_W.isZero(0.0) && at.j_W.isZero(0.0));
    EXPECT_EQ(at.psi_rad, 0.7);
  }
  const double nearly = leg.duration_s() - 1e-3;
  EXPECT_LT((leg.sample(nearly).p_W - leg.sample(leg.duration_s()).p_W).norm(), 1e-6);
}

TEST(FigureEight, DerivativesAreThoseOfThePosition) {
  const FigureEightLeg leg = eight(1, 0.4);
  constexpr double kStep_s = 1e-4;
  for (int k = 1; 0.0731 * k < leg.duration_s() - 0.05; ++k) {
    const double t = 0.0731 * k;
    const Trajectory before = leg.sample(t - kStep_s);
    const Trajectory at = leg.sample(t);
    const Trajectory after = leg.sample(t + kStep_s);
    EXPECT_LT(((after.p_W - before.p_W) / (2.0 * kStep_s) - at.v_W).norm(), 1e-6) << t;
    EXPECT_LT(((after.v_W - before.v_W) / (2.0 * kStep_s) - at.a_W).norm(), 1e-4) << t;
    EXPECT_LT(((after.a_W - before.a_W) / (2.0 * kStep_s) - at.j_W).norm(), 1e-2) << t;
  }
}

TEST(FigureEight, HasTheRadiusTheSpeedAndTheLobesItSays) {
  const FigureEightLeg leg = eight();
  double sharpest = 0.0;
  double fastest = 0.0;
  double north_high = 0.0, north_low = 0.0, east_high = 0.0, east_low = 0.0;
  double path_m = 0.0;
  Vector3 last = leg.sample(0.0).p_W;
  for (int k = 0; 1e-3 * k < leg.duration_s(); ++k) {
    const Trajectory at = leg.sample(1e-3 * k);
    const double v = at.v_W.norm();
    fastest = std::max(fastest, v);
    if (v > 1.0) sharpest = std::max(sharpest, at.v_W.cross(at.a_W).norm() / (v * v * v));
    const Vector3 p = at.p_W - Vector3(5.0, -3.0, -10.0);
    north_high = std::max(north_high, p.x());
    north_low = std::min(north_low, p.x());
    east_high = std::max(east_high, p.y());
    east_low = std::min(east_low, p.y());
    path_m += (at.p_W - last).norm();
    last = at.p_W;
  }
  EXPECT_NEAR(fastest, kSpeed_m_s, 1e-9);
  EXPECT_NEAR(1.0 / sharpest, kRadius_m, 0.01);
  EXPECT_NEAR(path_m, leg.length_m(), 0.02);
  // By numerical integration of the course, in another program.
  EXPECT_NEAR(north_high, 2.832143 * kRadius_m, 1e-3);
  EXPECT_NEAR(north_low, -2.832143 * kRadius_m, 1e-3);
  EXPECT_NEAR(east_high - east_low, 2.094318 * kRadius_m, 1e-3);
}

TEST(FigureEight, SmallOnesAreFlownSlower) {
  Trajectory start;
  const FigureEightLeg leg(start, 0.5, 1, 0.0, kSpeed_m_s, 3.0);
  double fastest = 0.0;
  for (int k = 0; 0.01 * k < leg.duration_s(); ++k) {
    fastest = std::max(fastest, leg.sample(0.01 * k).v_W.norm());
  }
  EXPECT_LT(fastest, 3.0);
  EXPECT_GT(fastest, 1.0);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
