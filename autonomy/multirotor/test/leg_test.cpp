// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/leg.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "autonomy/multirotor/angles.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

// Limits of roscopter's shipped file: 3 m/s, 5 m/s^2. The heading is given so much that it never
// decides.
constexpr LegLimits kShipped{3.0, 5.0, 10.0, 100.0};

Trajectory at(double n, double e, double d, double psi = 0.0) {
  Trajectory t;
  t.p_W = {n, e, d};
  t.psi_rad = psi;
  return t;
}

double duration(const Vector3& from, const Vector3& to, const LegLimits& limits = kShipped) {
  return QuinticLeg(at(from.x(), from.y(), from.z()), to, 0.0, limits).duration_s();
}

TEST(QuinticLeg, DurationsOfTheReferenceMission) {
  // ROSflight 2.x, roscopter 2.0.0: legs of the shipped example at v_max 3, a_max 5.
  const Vector3 w0(0, 0, -10), w1(20, 0, -10), w2(20, -20, -20), w3(0, -20, -20), w4(0, 0, -40);
  EXPECT_NEAR(duration(w0, w1), 12.5, 1e-12);
  EXPECT_NEAR(duration(w1, w2), 13.975, 5e-4);
  EXPECT_NEAR(duration(w2, w3), 12.5, 1e-12);
  EXPECT_NEAR(duration(w3, w4), 17.678, 5e-4);
  EXPECT_NEAR(duration(w4, w0), 18.75, 1e-12);
}

TEST(QuinticLeg, AccelerationLimitsLegsBelow2956Millimetres) {
  // v_max^2 5.7735/(1.875^2 a_max) = 2.956 m
  const double change = 2.9560;
  EXPECT_GT(duration({0, 0, 0}, {change - 0.01, 0, 0}), 1.875 * (change - 0.01) / 3.0);
  EXPECT_NEAR(duration({0, 0, 0}, {change + 0.01, 0, 0}), 1.875 * (change + 0.01) / 3.0, 1e-12);
}

TEST(QuinticLeg, SigmaAndItsDerivatives) {
  // One metre in one second: sigma = 6t^5 - 15t^4 + 10t^3.
  const LegLimits limits{1.875, 100.0, 10.0, 100.0};
  const QuinticLeg leg(at(0, 0, 0), {1, 0, 0}, 0.0, limits);
  ASSERT_NEAR(leg.duration_s(), 1.0, 1e-12);
  const Trajectory start = leg.sample(0.0);
  EXPECT_EQ(start.p_W.x(), 0.0);
  EXPECT_EQ(start.v_W.x(), 0.0);
  EXPECT_EQ(start.a_W.x(), 0.0);
  const Trajectory middle = leg.sample(0.5);
  EXPECT_NEAR(middle.p_W.x(), 0.5, 1e-12);
  EXPECT_NEAR(middle.v_W.x(), 1.875, 1e-12);
  EXPECT_NEAR(middle.a_W.x(), 0.0, 1e-11);
  const Trajectory peak = leg.sample((3.0 - std::sqrt(3.0)) / 6.0);
  EXPECT_NEAR(peak.a_W.x(), 10.0 / std::sqrt(3.0), 1e-11);
  const Trajectory quarter = leg.sample(0.25);
  EXPECT_NEAR(quarter.p_W.x(), 53.0 / 512.0, 1e-12);
  EXPECT_NEAR(quarter.v_W.x(), 135.0 / 128.0, 1e-12);
  EXPECT_NEAR(quarter.a_W.x(), 5.625, 1e-11);
}

// Weak point 20: after the end the last sample, not the waypoint, was repeated.
TEST(QuinticLeg, EndsExactlyAndAtRest) {
  const QuinticLeg leg(at(0.1, 0.2, -0.3, 1.0), {7.7, -1.3, -9.1}, 2.5, kShipped);
  for (const double t : {leg.duration_s(), leg.duration_s() + 1e-9, leg.duration_s() + 100.0}) {
    const Trajectory end = leg.sample(t);
    EXPECT_EQ(end.p_W, Vector3(7.7, -1.3, -9.1));
    EXPECT_TRUE(end.v_W.isZero(0.0));
    EXPECT_TRUE(end.a_W.isZero(0.0));
    EXPECT_NEAR(end.psi_rad, 2.5, 1e-15);
    EXPECT_EQ(end.psi_dot_rad_s, 0.0);
  }
}

// Weak point 19: T = 0 gave NaN.
TEST(QuinticLeg, NoWayAndNoTurnIsALegOfNoTime) {
  const QuinticLeg leg(at(1, 2, -3, 0.5), {1, 2, -3}, 0.5, kShipped);
  EXPECT_EQ(leg.duration_s(), 0.0);
  EXPECT_EQ(leg.sample(0.0).p_W, Vector3(1, 2, -3));
  EXPECT_NEAR(leg.sample(5.0).psi_rad, 0.5, 1e-15);
}

// Weak point 19: a leg that only turns was not possible.
TEST(QuinticLeg, TurnsOnTheSpot) {
  const LegLimits limits{3.0, 5.0, 1.0, 2.0};
  const QuinticLeg leg(at(1, 2, -3, 0.0), {1, 2, -3}, 1.0, limits);
  EXPECT_NEAR(leg.duration_s(), 1.875, 1e-12);
  EXPECT_NEAR(leg.sample(0.5 * leg.duration_s()).psi_dot_rad_s, 1.0, 1e-12);
  EXPECT_NEAR(leg.sample(0.5 * leg.duration_s()).psi_rad, 0.5, 1e-12);
  EXPECT_EQ(leg.sample(0.7).p_W, Vector3(1, 2, -3));
}

// Weak point 22: the heading was interpolated without wrapping.
TEST(QuinticLeg, HeadingTurnsTheShortWay) {
  const double from = 170.0 * kRadPerDeg;
  const double to = -170.0 * kRadPerDeg;
  const QuinticLeg leg(at(0, 0, 0, from), {10, 0, 0}, to, kShipped);
  for (int k = 0; k <= 1000; ++k) {
    const Trajectory s = leg.sample(leg.duration_s() * k / 1000.0);
    EXPECT_GE(s.psi_dot_rad_s, -1e-12);
    EXPECT_GE(std::abs(s.psi_rad), 170.0 * kRadPerDeg - 1e-12);
  }
  EXPECT_NEAR(leg.sample(leg.duration_s()).psi_rad, to, 1e-12);
}

TEST(QuinticLeg, TakesOverTheMotionOfItsStart) {
  Trajectory start = at(1, 2, -3, 0.4);
  start.v_W = {2.0, -1.0, 0.5};
  start.a_W = {0.3, 0.2, -0.1};
  start.psi_dot_rad_s = 0.5;
  start.psi_ddot_rad_s2 = -0.2;
  const QuinticLeg leg(start, {12, 4, -6}, 1.4, kShipped);
  const Trajectory s = leg.sample(0.0);
  EXPECT_TRUE(s.p_W.isApprox(start.p_W, 1e-12));
  EXPECT_TRUE(s.v_W.isApprox(start.v_W, 1e-12));
  EXPECT_TRUE(s.a_W.isApprox(start.a_W, 1e-12));
  EXPECT_NEAR(s.psi_dot_rad_s, 0.5, 1e-12);
  EXPECT_NEAR(s.psi_ddot_rad_s2, -0.2, 1e-12);
  EXPECT_EQ(leg.sample(leg.duration_s()).p_W, Vector3(12, 4, -6));
}

TEST(QuinticLeg, KeepsTheLimitsFromAnyStart) {
  unsigned seed = 1;
  const auto random = [&seed] {  // a fixed sequence in -1..1
    seed = seed * 1664525U + 1013904223U;
    return static_cast<double>(seed >> 8U) / 8388608.0 - 1.0;
  };
  const LegLimits limits{4.0, 3.0, 1.0, 2.0};
  for (int k = 0; k < 200; ++k) {
    Trajectory start = at(random() * 5, random() * 5, random() * 5, random() * 3);
    start.v_W = Vector3(random(), random(), random()) * 2.0;
    start.psi_dot_rad_s = random();
    const Vector3 to(random() * 20, random() * 20, random() * 20);
    const QuinticLeg leg(start, to, random() * 3, limits);
    for (int i = 0; i < 200; ++i) {
      const Trajectory s = leg.sample(leg.duration_s() * i / 200.0);
      // 3 %: the limits are checked at 24 points of the leg, extrema may lie between
      EXPECT_LE(s.v_W.norm(), 1.03 * std::max(limits.speed_m_s, 1.1 * start.v_W.norm()));
      EXPECT_LE(s.a_W.norm(), 1.03 * limits.acceleration_m_s2);
      EXPECT_LE(std::abs(s.psi_dot_rad_s),
                1.03 * std::max(limits.yaw_rate_rad_s, 1.1 * std::abs(start.psi_dot_rad_s)));
    }
  }
}

TEST(QuinticLeg, VelocityIsTheDerivativeOfPosition) {
  Trajectory start = at(0, 0, -2, 3.0);
  start.v_W = {1, 0.5, 0};
  const QuinticLeg leg(start, {9, -4, -6}, -3.0, kShipped);
  const double h = 1e-5;
  for (int k = 1; k < 20; ++k) {
    const double t = leg.duration_s() * k / 20.0;
    const Vector3 v = (leg.sample(t + h).p_W - leg.sample(t - h).p_W) / (2.0 * h);
    const Vector3 a = (leg.sample(t + h).v_W - leg.sample(t - h).v_W) / (2.0 * h);
    // central differences: h^2 of the third derivative, and rounding over h
    EXPECT_LT((v - leg.sample(t).v_W).norm(), 1e-8);
    const Vector3 j = (leg.sample(t + h).a_W - leg.sample(t - h).a_W) / (2.0 * h);
    EXPECT_LT((a - leg.sample(t).a_W).norm(), 1e-8);
    EXPECT_LT((j - leg.sample(t).j_W).norm(), 1e-8);
  }
}

TEST(LinearLeg, ConstantAccelerationBetweenTwoSpeeds) {
  // 12 m from 2 to 4 m/s: T = 24/6 = 4 s, a = 0.5 m/s^2
  const LinearLeg leg(at(0, 0, 0), {0, 12, 0}, 0.0, 2.0, 4.0, kShipped);
  EXPECT_NEAR(leg.duration_s(), 4.0, 1e-12);
  const Trajectory s = leg.sample(2.0);
  EXPECT_NEAR(s.p_W.y(), 2.0 * 2.0 + 0.25 * 4.0, 1e-12);
  EXPECT_NEAR(s.v_W.y(), 3.0, 1e-12);
  EXPECT_NEAR(s.a_W.y(), 0.5, 1e-12);
  EXPECT_EQ(leg.sample(4.0).p_W.y(), 12.0);
  EXPECT_NEAR(leg.sample(4.0).v_W.y(), 4.0, 1e-12);
}

// Weak point 24: two zero speeds never moved.
TEST(LinearLeg, TwoZeroSpeedsFlyATrapezoid) {
  // 30 m at 3 m/s, 5 m/s^2: ramps of 0.6 s, T = 30/3 + 0.6
  const LinearLeg leg(at(0, 0, 0), {30, 0, 0}, 0.0, 0.0, 0.0, kShipped);
  EXPECT_NEAR(leg.duration_s(), 10.6, 1e-12);
  EXPECT_NEAR(leg.sample(0.3).v_W.x(), 1.5, 1e-12);
  EXPECT_NEAR(leg.sample(5.3).p_W.x(), 15.0, 1e-12);
  EXPECT_NEAR(leg.sample(5.3).v_W.x(), 3.0, 1e-12);
  EXPECT_NEAR(leg.sample(10.3).v_W.x(), 1.5, 1e-12);
  EXPECT_NEAR(leg.sample(10.6 - 1e-9).p_W.x(), 30.0, 1e-12);
  // 1.25 m: no cruise, peak sqrt(1.25 * 5) = 2.5 m/s after 0.5 s
  const LinearLeg brief(at(0, 0, 0), {1.25, 0, 0}, 0.0, 0.0, 0.0, kShipped);
  EXPECT_NEAR(brief.duration_s(), 1.0, 1e-12);
  EXPECT_NEAR(brief.sample(0.5).v_W.x(), 2.5, 1e-12);
}

TEST(LinearLeg, HeadingFollowsTheWayTheShortWay) {
  const LinearLeg leg(at(0, 0, 0, 3.0), {12, 0, 0}, -3.0, 2.0, 4.0, kShipped);
  const double turn = 2.0 * kPi - 6.0;
  EXPECT_NEAR(leg.sample(2.0).psi_dot_rad_s, turn * 3.0 / 12.0, 1e-12);
  EXPECT_NEAR(leg.sample(2.0).psi_rad, wrap_angle(3.0 + turn * 5.0 / 12.0), 1e-12);
}

TEST(WrapAngle, StaysInTheHalfOpenTurn) {
  EXPECT_EQ(wrap_angle(0.3), 0.3);
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(3.0 * kPi - 0.1), kPi - 0.1, 1e-12);
  EXPECT_NEAR(wrap_angle(-7.0), -7.0 + 2.0 * kPi, 1e-12);
  EXPECT_NEAR(wrap_angle(1000.0), 1000.0 - 318.0 * kPi, 1e-10);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
