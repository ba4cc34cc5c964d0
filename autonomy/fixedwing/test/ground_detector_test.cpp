// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/ground_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kStep_s = 0.02;

StateEstimate at(double height_m, double sink_m_s) {
  StateEstimate state;
  state.p_W.z() = -height_m;
  state.v_W = {12.0, 0.0, sink_m_s};
  return state;
}

/// Steps until it is on the ground; the time this took, 0 if it is not within 5 s.
double time_to_touch_s(double height_m, double sink_m_s, bool descending, bool flaring) {
  GroundDetector detector;
  for (int k = 1; k < 250; ++k) {
    if (detector.on_ground(at(height_m, sink_m_s), height_m, descending, flaring, kStep_s)) {
      return k * kStep_s;
    }
  }
  return 0.0;
}

// Banked by 30 degrees 5 m above the ground, the beam is 5/cos(30 deg) = 5.7735 m long.
TEST(GroundDetector, RangeIsLevelledAndCountsFromStanding) {
  GroundDetector detector;
  detector.set_standing(0.3);
  StateEstimate state = at(100.0, 0.0);
  state.q_WB = Eigen::AngleAxisd(30.0 * kRadPerDeg, Vector3::UnitX());
  EXPECT_NEAR(detector.height_m(state, 5.773502691896258, 8.0, 0.0), 5.0 - 0.3, 1e-12);
}

TEST(GroundDetector, UnusableRangeGivesTheAltitudeAboveTheGivenGround) {
  GroundDetector detector;
  detector.set_standing(0.3);
  StateEstimate state = at(12.0, 0.0);
  for (const std::optional<double> range : {std::optional<double>{}, std::optional(std::nan("")),
                                            std::optional(-0.1), std::optional(8.1)}) {
    EXPECT_EQ(detector.height_m(state, range, 8.0, 2.0), 10.0);
  }
  state.q_WB = Eigen::AngleAxisd(40.0 * kRadPerDeg, Vector3::UnitY());
  EXPECT_EQ(detector.height_m(state, 5.0, 8.0, 2.0), 10.0);
}

TEST(GroundDetector, LevelRollingForATimeIsTouchDown) {
  EXPECT_NEAR(time_to_touch_s(0.0, 0.0, true, true), 0.4, 1.5 * kStep_s);
  EXPECT_NEAR(time_to_touch_s(0.0, 0.0, true, false), 1.2, 1.5 * kStep_s);
  EXPECT_EQ(time_to_touch_s(0.0, 0.3, true, true), 0.0) << "still sinks";
  EXPECT_EQ(time_to_touch_s(3.1, 0.0, true, true), 0.0) << "level, but high";
  EXPECT_EQ(time_to_touch_s(0.0, 0.0, false, true), 0.0) << "not on the way down";
}

TEST(GroundDetector, AGustThatHoldsItAboveTheGroundIsNoTouchDown) {
  GroundDetector detector;
  const StateEstimate state = at(0.8, 0.0);
  double time_s = 0.0;
  for (bool down = false; !down; time_s += kStep_s) {
    const double height_m = detector.height_m(state, 0.8, 8.0, 0.0);
    down = detector.on_ground(state, height_m, true, true, kStep_s);
  }
  EXPECT_NEAR(time_s, 3.0, 2.5 * kStep_s);
}

TEST(GroundDetector, StandsAfterASecondWithoutSpeed) {
  GroundDetector detector;
  StateEstimate state = at(0.0, 0.0);
  EXPECT_FALSE(detector.stands(state, 2.0)) << "12 m/s";
  state.v_W.x() = 0.9;
  EXPECT_FALSE(detector.stands(state, 0.9));
  EXPECT_TRUE(detector.stands(state, 0.2));
  state.v_W.x() = 1.1;
  EXPECT_FALSE(detector.stands(state, 0.2));
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
