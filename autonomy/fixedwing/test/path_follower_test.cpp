// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/path_follower.hpp"

#include <gtest/gtest.h>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/path_manager.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kG = 9.80665;

StateEstimate flying(double n, double e, double h, double course_rad, double speed = 15.0) {
  StateEstimate s;
  s.p_W = {n, e, -h};
  s.v_W << speed * along(course_rad), 0.0;
  s.q_WB = Quaternion(std::cos(0.5 * course_rad), 0.0, 0.0, std::sin(0.5 * course_rad));
  s.course_rad = course_rad;
  s.airspeed_m_s = speed;
  return s;
}

CurrentPath line(double course_rad, double slope = 0.0) {
  CurrentPath p;
  p.valid = true;
  p.airspeed_m_s = 15.0;
  p.r_W = {0.0, 0.0, -50.0};
  p.q_W << along(course_rad), -slope;
  p.q_W.normalize();
  return p;
}

CurrentPath circle(int turn) {
  CurrentPath p;
  p.valid = true;
  p.circle = true;
  p.airspeed_m_s = 15.0;
  p.c_W = {0.0, 0.0, -50.0};
  p.radius_m = 50.0;
  p.turn = turn;
  return p;
}

TEST(PathFollower, OnTheLineItFliesAlongAndFromFarAtTheApproachAngle) {
  const PathFollower follower(FollowerConfig{.approach_rad = 1.2, .line_gain_1_m = 0.02});
  for (const double chi : {0.0, 1.0, -2.5, 3.1}) {
    const Vector2 on = 100.0 * along(chi);
    auto c = follower.step(flying(on.x(), on.y(), 50, chi), line(chi), 0.0);
    ASSERT_TRUE(c.valid);
    EXPECT_NEAR(wrap_angle(c.course_rad - chi), 0.0, 1e-9);
    EXPECT_NEAR(c.roll_ff_rad, 0.0, 1e-9);
    const Vector2 far = 1e6 * right_of(chi);
    c = follower.step(flying(far.x(), far.y(), 50, chi), line(chi), 0.0);
    EXPECT_NEAR(wrap_angle(c.course_rad - chi), -1.2, 1e-4);
    // At e = 1/k the arc tangent is pi/4: half the approach angle.
    const Vector2 half = -50.0 * right_of(chi);
    c = follower.step(flying(half.x(), half.y(), 50, chi), line(chi), 0.0);
    EXPECT_NEAR(wrap_angle(c.course_rad - chi), 0.6, 1e-9);
  }
}

TEST(PathFollower, CircleFieldHasItsThreeLimits) {
  const PathFollower follower(FollowerConfig{.circle_gain = 2.0});
  for (const int turn : {1, -1}) {
    // On the circle, north of the centre: clockwise flies east. Far out: to the centre.
    auto c = follower.step(flying(50, 0, 50, turn * 0.5 * kPi), circle(turn), 0.0);
    ASSERT_TRUE(c.valid);
    EXPECT_NEAR(c.course_rad, turn * 0.5 * kPi, 1e-9);
    c = follower.step(flying(1e7, 0, 50, 0.0), circle(turn), 0.0);
    EXPECT_NEAR(std::abs(wrap_angle(c.course_rad - kPi)), 0.0, 1e-4);
    // In the centre: outward by atan(k) short of the tangent.
    c = follower.step(flying(1e-3, 0, 50, 0.0), circle(turn), 0.0);
    EXPECT_NEAR(c.course_rad, turn * (0.5 * kPi - std::atan(2.0 * 49.0 / 50.0)), 1e-6);
  }
}

/// Coordinated turn in still air: tan(phi) = V^2/(g R).
TEST(PathFollower, BankOfACircleInStillAir) {
  const PathFollower follower(FollowerConfig{});
  const auto c = follower.step(flying(50, 0, 50, 0.5 * kPi), circle(1), 0.0);
  EXPECT_NEAR(c.roll_ff_rad, std::atan(15.0 * 15.0 / (kG * 50.0)), 1e-9);
}

/// Point 28: in wind along the course the ground speed counts, across it the crab angle too.
TEST(PathFollower, BankOfACircleInWind) {
  const PathFollower follower(FollowerConfig{});
  auto s = flying(50, 0, 50, 0.5 * kPi, 20.0);  // 15 m/s of air, 5 of tail wind
  EXPECT_NEAR(follower.step(s, circle(1), 0.0).roll_ff_rad, std::atan(400.0 / (kG * 50.0)), 1e-9);
  const double crab = std::asin(5.0 / 15.0);
  s = flying(50, 0, 50, 0.5 * kPi, 15.0 * std::cos(crab));
  const double psi = 0.5 * kPi - crab;
  s.q_WB = Quaternion(std::cos(0.5 * psi), 0.0, 0.0, std::sin(0.5 * psi));
  const double vg = 15.0 * std::cos(crab);
  EXPECT_NEAR(follower.step(s, circle(1), 0.0).roll_ff_rad,
              std::atan(vg * vg / (kG * 50.0 * std::cos(crab))), 1e-9);
  // Wind from the side, cos(chi - psi) = 0: bounded, and no change of sign.
  s = flying(50, 0, 50, 0.5 * kPi, 6.0);
  s.q_WB = Quaternion::Identity();
  EXPECT_GT(follower.step(s, circle(1), 0.0).roll_ff_rad, 0.0);
  EXPECT_LT(follower.step(s, circle(1), 0.0).roll_ff_rad, kPi / 4.0 + 1e-9);
}

/// Point 28: far from the circle its field is straight, so no bank is fed forward.
TEST(PathFollower, BankFadesFarFromTheCircle) {
  const PathFollower follower(FollowerConfig{});
  const auto c = follower.step(flying(5000, 0, 50, kPi), circle(1), 0.0);
  EXPECT_NEAR(c.roll_ff_rad, 0.0, 0.01);
}

/// The bank fed forward is that of the field's change along the flight, by differences.
TEST(PathFollower, BankIsTheTotalDerivativeOfTheField) {
  const PathFollower follower(FollowerConfig{.max_roll_ff_rad = 1.5});
  constexpr double kDt = 1e-5;
  for (double chi = -3.0; chi < 3.1; chi += 0.37) {
    for (const double east : {-180.0, -55.0, 20.0, 90.0}) {
      for (const CurrentPath& path : {circle(1), circle(-1), line(0.4)}) {
        const auto now = flying(30.0, east, 50, chi);
        const Vector2 then = now.p_W.head<2>() + 15.0 * kDt * along(chi);
        const auto a = follower.step(now, path, 0.0);
        const auto b = follower.step(flying(then.x(), then.y(), 50, chi), path, 0.0);
        const double rate = wrap_angle(b.course_rad - a.course_rad) / kDt;
        EXPECT_NEAR(std::tan(a.roll_ff_rad), 15.0 * rate / kG, 1e-3);
      }
    }
  }
}

/// Point 27: height belongs to the foot on the line, signed, not to the distance from its origin.
TEST(PathFollower, HeightIsThatOfTheFootOnTheLine) {
  const PathFollower follower(FollowerConfig{});
  const CurrentPath path = line(0.0, 0.1);
  EXPECT_NEAR(follower.step(flying(200, 0, 50, 0), path, 0.0).height_m, 70.0, 1e-9);
  EXPECT_NEAR(follower.step(flying(200, 150, 50, 0), path, 0.0).height_m, 70.0, 1e-9);
  EXPECT_NEAR(follower.step(flying(-100, 30, 50, 0), path, 0.0).height_m, 40.0, 1e-9);
  EXPECT_NEAR(follower.step(flying(0, 0, 50, 0), path, 0.0).climb_ff_m_s, 1.5, 1e-9);
}

/// Points 11, 27, and the timeout: without a path the command is not valid.
TEST(PathFollower, StopsWithoutAPath) {
  const PathFollower follower(FollowerConfig{.timeout_s = 1.0});
  const auto s = flying(0, 0, 50, 0);
  EXPECT_FALSE(follower.step(s, CurrentPath{}, 0.0).valid);
  EXPECT_TRUE(follower.step(s, line(0.0), 0.9).valid);
  EXPECT_FALSE(follower.step(s, line(0.0), 1.1).valid);
  EXPECT_FALSE(follower.step(s, line(0.0), -0.1).valid);
  CurrentPath up = line(0.0);
  up.q_W = {0.0, 0.0, -1.0};
  EXPECT_FALSE(follower.step(s, up, 0.0).valid);
  CurrentPath none = circle(1);
  none.radius_m = 0.0;
  EXPECT_FALSE(follower.step(s, none, 0.0).valid);
  CurrentPath slow = line(0.0);
  slow.airspeed_m_s = 0.0;
  EXPECT_FALSE(follower.step(s, slow, 0.0).valid);
  auto sick = s;
  sick.v_W.x() = std::nan("");
  EXPECT_FALSE(follower.step(sick, line(0.0), 0.0).valid);
}

/// A point mass that turns as it banks comes onto line and circle in any wind up to most of its
/// airspeed, from anywhere, by the field alone.
TEST(PathFollower, ConvergesInWind) {
  const PathFollower follower(FollowerConfig{.max_roll_ff_rad = 1.0});
  for (const double wind : {0.0, 5.0, 8.0}) {
    for (const CurrentPath& path : {line(2.0), circle(1), circle(-1)}) {
      Vector2 p(230.0, -170.0);
      double psi = 0.3;
      const double dt = 0.02;
      Segment reference;
      double worst = 0.0;
      for (int k = 0; k < 10000; ++k) {
        const Vector2 v = 15.0 * along(psi) + Vector2(wind, 0.0);
        auto s = flying(p.x(), p.y(), 50, course_of(v), v.norm());
        s.q_WB = Quaternion(std::cos(0.5 * psi), 0.0, 0.0, std::sin(0.5 * psi));
        const auto c = follower.step(s, path, 0.0);
        ASSERT_TRUE(c.valid);
        const double roll =
            std::clamp(c.roll_ff_rad + 2.0 * wrap_angle(c.course_rad - s.course_rad), -0.9, 0.9);
        psi += kG / 15.0 * std::tan(roll) * dt;
        p += v * dt;
        if (k < 7500) continue;
        const double error = path.circle ? p.norm() - 50.0 : p.dot(right_of(2.0));
        worst = std::max(worst, std::abs(error));
      }
      EXPECT_LT(worst, 0.5) << "wind " << wind << " circle " << path.circle;
    }
  }
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
