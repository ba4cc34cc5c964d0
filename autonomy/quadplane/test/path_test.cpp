// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/path.hpp"

#include <gtest/gtest.h>

#include <random>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

/// North 300 m, then east 300 m: one right angle, which takes R tan(45 deg) = R of both legs.
Path corner(double radius_m = 100.0) {
  Path path;
  EXPECT_EQ(path.build({{0.0, 0.0, -30.0}, {300.0, 0.0, -40.0}, {300.0, 300.0, -20.0}}, radius_m),
            0U);
  return path;
}

/// Follows a path by its own points, 1 m at a time, and hands each to a function.
template <typename Visit>
void walk(Path& path, const Visit& visit) {
  Path::Point at = path.follow({0.0, 0.0, 0.0});
  double left_m = at.left_m + 1.0;
  while (left_m - at.left_m > 0.5 && at.left_m > 0.5) {
    left_m = at.left_m;
    const Vector3 ahead(std::cos(at.course_rad), std::sin(at.course_rad), 0.0);
    at = path.follow(at.p_W + ahead);
    visit(at);
  }
}

/// Two straights of 200 m and a quarter of a circle.
TEST(Path, LengthIsThatOfStraightsAndArc) {
  Path path = corner();
  EXPECT_NEAR(path.follow({0.0, 0.0, -30.0}).left_m, 400.0 + 50.0 * kPi, 1e-9);
}

/// The middle of the corner is R (sqrt 2 - 1) from the waypoint, and at its height.
TEST(Path, PassesTheMiddleOfACornerAtTheHeightOfItsWaypoint) {
  Path path = corner();
  double nearest_m = kInfinity;
  double height_m = 0.0;
  walk(path, [&](const Path::Point& at) {
    const double distance_m = (at.p_W.head<2>() - Eigen::Vector2d(300.0, 0.0)).norm();
    if (distance_m >= nearest_m) return;
    nearest_m = distance_m;
    height_m = -at.p_W.z();
  });
  EXPECT_NEAR(nearest_m, 100.0 * (std::sqrt(2.0) - 1.0), 0.05);
  EXPECT_NEAR(height_m, 40.0, 0.05);
}

/// A step of the slope is a step of the climb that a wing cannot follow: 0.1 at 25 m/s are 2.5 m/s. The largest bend
/// of 3 x^2 - 2 x^3 is 6 h/L^2, here of 20 m over 200 m and half of the arc.
TEST(Path, SlopeHasNoStep) {
  Path path = corner();
  const double length_m = 200.0 + 25.0 * kPi;
  double before = path.follow({0.0, 0.0, 0.0}).slope;
  double largest = 0.0;
  double steepest = 0.0;
  walk(path, [&](const Path::Point& at) {
    largest = std::max(largest, std::abs(at.slope - before));
    steepest = std::max(steepest, std::abs(at.slope));
    before = at.slope;
  });
  EXPECT_LT(largest, 1.1 * 6.0 * 20.0 / (length_m * length_m));
  EXPECT_NEAR(steepest, path.steepest(2), 1e-3);
  EXPECT_NEAR(path.steepest(2), 1.5 * 20.0 / length_m, 1e-9);
}

TEST(Path, BendIsTheChangeOfTheSlope) {
  Path path = corner();
  double before = 0.0;
  bool first = true;
  walk(path, [&](const Path::Point& at) {
    // Where two pieces meet the bend itself has a step.
    if (!first && std::abs(at.before_m) > 2.0 && at.left_m > 2.0) {
      EXPECT_NEAR(at.slope - before, at.bend_1_m, 3e-4) << at.left_m << " m left";
    }
    first = false;
    before = at.slope;
  });
}

TEST(Path, CurvatureIsSeenAhead) {
  Path path = corner();
  static_cast<void>(path.follow({190.0, 0.0, 0.0}));
  EXPECT_EQ(path.curvature_ahead(5.0), 0.0);
  EXPECT_NEAR(path.curvature_ahead(15.0), 0.01, 1e-12);
}

TEST(Path, RefusesALegThatIsTooShortForItsCorners) {
  Path path;
  EXPECT_EQ(
      path.build({{0.0, 0.0, 0.0}, {300.0, 0.0, 0.0}, {300.0, 90.0, 0.0}, {0.0, 90.0, 0.0}}, 100.0),
      2U);
}

/// A later leg over the same ground is not taken for the present one.
TEST(Path, IsJoinedOnThePresentStraightItsCornerOrTheNext) {
  Path path;
  ASSERT_EQ(path.build({{0.0, 0.0, 0.0},
                        {400.0, 0.0, 0.0},
                        {400.0, 300.0, 0.0},
                        {100.0, 300.0, 0.0},
                        {100.0, -200.0, 0.0}},
                       50.0),
            0U);
  static_cast<void>(path.follow({50.0, 0.0, 0.0}));
  path.rejoin({100.0, 5.0, 0.0});  // the last leg passes 5 m from here
  EXPECT_EQ(path.follow({100.0, 5.0, 0.0}).waypoint, 0U);
  path.rejoin({402.0, 150.0, 0.0});
  EXPECT_EQ(path.follow({402.0, 150.0, 0.0}).waypoint, 1U);
}

/// Random starts: the path begins where the vehicle is, with its course, and ends at the goal; it has no corner.
TEST(Path, GoesToAPointFromAnyPositionAndCourse) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> where(-400.0, 400.0);
  std::uniform_real_distribution<double> any(-kPi, kPi);
  for (int k = 0; k < 300; ++k) {
    const Vector3 p_W(where(random), where(random), -50.0);
    const double course = any(random);
    Path path;
    path.go_to(p_W, course, 80.0, {0.0, 0.0, -30.0});
    Path::Point at = path.follow(p_W);
    EXPECT_LT((at.p_W - p_W).norm(), 1e-6);
    EXPECT_NEAR(wrap_angle(at.course_rad - course), 0.0, 1e-6);
    // Never longer than a whole turn and the farthest point of it from the goal.
    EXPECT_LT(at.left_m, 2.0 * kPi * 80.0 + p_W.head<2>().norm() + 160.0);
    double course_before = at.course_rad;
    int steps = 0;
    while (at.left_m > 1.0 && ++steps < 3000) {
      at = path.follow(at.p_W + Vector3(std::cos(at.course_rad), std::sin(at.course_rad), 0.0));
      EXPECT_LT(std::abs(wrap_angle(at.course_rad - course_before)), 1.1 / 80.0);
      course_before = at.course_rad;
    }
    EXPECT_LT((at.p_W - Vector3(0.0, 0.0, -30.0)).norm(), 2.0);
  }
}

TEST(Path, WithoutARadiusItGoesStraight) {
  Path path;
  path.go_to({100.0, 0.0, -30.0}, 0.3, 0.0, {0.0, 0.0, -30.0});
  const Path::Point& at = path.follow({100.0, 0.0, -30.0});
  EXPECT_NEAR(at.left_m, 100.0, 1e-9);
  EXPECT_NEAR(std::abs(at.course_rad), kPi, 1e-9);
}

}  // namespace
}  // namespace rosflight::autonomy::quadplane
