// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/path_manager.hpp"

#include <gtest/gtest.h>

#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

/// Leads a point along its own path by what it receives, like a perfect vehicle.
std::vector<std::size_t> walk(PathManager& manager, Vector3 p_W, double metres) {
  std::vector<std::size_t> passed;
  for (double s = 0.0; s < metres; s += 0.5) {
    const auto& out = manager.step(p_W);
    if (out.passed) passed.push_back(*out.passed);
    if (out.done) break;
    const Segment& segment = out.segment;
    const double next = out.progress_m + 0.5;
    p_W.head<2>() = segment.point_at(next);
    p_W.z() = -segment.height_at(next);
    EXPECT_LT(std::abs(out.cross_track_m), 1.0);
  }
  return passed;
}

/// Points 10, 14: nothing before a start; from then on the order of the list, each once a round.
TEST(FixedWingPathManager, PassesEveryWaypointInOrder) {
  for (const Passing passing : {Passing::kLine, Passing::kFillet, Passing::kDubins}) {
    PathManager manager(PlannerConfig{});
    manager.set_waypoints(hourglass(passing).waypoints, true);
    EXPECT_FALSE(manager.step({0, 0, -60}).path.valid);
    ASSERT_FALSE(manager.start({{{0, 0}, -0.5}, 60.0}));
    const auto passed = walk(manager, {0, 0, -60}, 7000.0);
    ASSERT_GE(passed.size(), 9U);
    for (std::size_t k = 0; k < passed.size(); ++k) EXPECT_EQ(passed[k], k % 4);
  }
}

/// Points 12, 13: a new list forgets everything of the old one.
TEST(FixedWingPathManager, NewListForgetsTheOld) {
  PathManager manager(PlannerConfig{});
  manager.set_waypoints(hourglass(Passing::kDubins).waypoints, true);
  ASSERT_FALSE(manager.start({{{0, 0}, 0.0}, 60.0}));
  walk(manager, {0, 0, -60}, 1000.0);
  manager.set_waypoints(hourglass(Passing::kFillet).waypoints, false);
  EXPECT_FALSE(manager.step({0, 0, -60}).path.valid);
  ASSERT_FALSE(manager.start({{{10, 20}, 0.0}, 60.0}));
  EXPECT_EQ(manager.step({10, 20, -60}).waypoint, 0U);
  EXPECT_EQ(walk(manager, {10, 20, -60}, 6000.0), (std::vector<std::size_t>{0, 1, 2, 3}));
}

/// Point 15: the last point is circled with a whole path message.
TEST(FixedWingPathManager, CirclesTheLastWaypointForEver) {
  std::vector<Waypoint> list = hourglass().waypoints;
  list.back().passing = Passing::kCircle;
  list.back().turn = -1;
  list.back().hold_indefinitely = true;
  PathManager manager(PlannerConfig{});
  manager.set_waypoints(list, false);
  ASSERT_FALSE(manager.start({{{0, 0}, 0.0}, 60.0}));
  walk(manager, {0, 0, -60}, 9000.0);
  const auto& out = manager.output();
  EXPECT_FALSE(out.done);
  EXPECT_TRUE(out.path.valid);
  EXPECT_TRUE(out.path.circle);
  EXPECT_EQ(out.path.turn, -1);
  EXPECT_EQ(out.path.radius_m, 50.0);
  EXPECT_EQ(out.path.airspeed_m_s, 17.0);
  EXPECT_LT((out.path.c_W.head<2>() - Vector2(400, -50)).norm(), 1e-9);
}

/// Point 16: a circle of open sense is joined in the sense with the shorter path to it.
TEST(FixedWingPathManager, CircleOfOpenSenseIsJoinedTheShorterWay) {
  const Planner planner(PlannerConfig{});
  for (double course = -3.0; course < 3.0; course += 0.4) {
    const PathStart start{{{0, 0}, course}, 60.0};
    Waypoint wp;
    wp.p_W = {200.0, 60.0, -60.0};
    wp.passing = Passing::kCircle;
    wp.hold_indefinitely = true;
    double path_m[3] = {};
    int sense = 0;
    for (const int turn : {-1, 0, 1}) {
      wp.turn = turn;
      Plan plan;
      ASSERT_FALSE(planner.plan(start, std::vector{wp}, false, 0, plan));
      for (const Segment& s : plan.segments) {
        if (std::isfinite(s.length_m)) path_m[turn + 1] += s.length_m;
      }
      if (turn == 0) sense = plan.segments.back().radius_m > 0.0 ? 1 : -1;
    }
    EXPECT_EQ(path_m[1], std::min(path_m[0], path_m[2]));
    EXPECT_EQ(path_m[1], path_m[sense + 1]);
  }
}

/// Points 17, 18: an arc is left by its angle, so a vehicle beside it takes no plane from the wrong
/// side and never goes back to the first arc.
TEST(FixedWingPathManager, BesideTheArcItStillGoesOn) {
  PathManager manager(PlannerConfig{});
  auto list = hourglass(Passing::kDubins).waypoints;
  manager.set_waypoints(list, false);
  ASSERT_FALSE(manager.start({{{0, 0}, 0.0}, 70.0}));
  std::size_t last = 0;
  double path_m = 0.0;
  for (int k = 0; k < 20000 && !manager.output().done; ++k) {
    const auto& now = manager.output();
    Vector2 p = Vector2::Zero();
    if (k > 0) {
      // Always 15 m outside of where it should be.
      p = now.segment.point_at(now.progress_m + 0.5) +
          15.0 * right_of(now.segment.course_at(now.progress_m)) *
              (now.segment.radius_m > 0.0 ? -1.0 : 1.0);
    }
    const auto& out = manager.step({p.x(), p.y(), -70.0});
    EXPECT_GE(out.waypoint, last);
    last = out.waypoint;
    path_m += 0.5;
  }
  EXPECT_TRUE(manager.output().done);
  EXPECT_LT(path_m, 5000.0);
}

/// Point 20: on the arcs of a climbing Dubins leg the height reference has no step.
TEST(FixedWingPathManager, HeightReferenceHasNoStep) {
  auto list = hourglass(Passing::kDubins).waypoints;
  list[1].p_W.z() = -110.0;
  list[2].p_W.z() = -90.0;
  PathManager manager(PlannerConfig{});
  manager.set_waypoints(list, false);
  ASSERT_FALSE(manager.start({{{0, 0}, 2.0}, 40.0}));
  Vector3 p_W(0, 0, -40);
  double height = 40.0;
  double steepest = 0.0;
  for (double s = 0.0; s < 5000.0; s += 0.5) {
    const auto& out = manager.step(p_W);
    if (out.done) break;
    EXPECT_LT(std::abs(out.height_m - height), 0.12);
    steepest = std::max(steepest, std::abs(out.segment.slope()));
    height = out.height_m;
    p_W << out.segment.point_at(out.progress_m + 0.5), -height;
    if (out.path.circle) {
      EXPECT_NEAR(out.path.c_W.z(), -out.height_m, 1e-9);
    }
  }
  EXPECT_TRUE(manager.output().done);
  EXPECT_LE(steepest, 0.15 + 1e-12);
}

TEST(FixedWingPathManager, LeadsTheFollowerButNotTheReference) {
  PathManager manager(PlannerConfig{});
  manager.set_waypoints(hourglass().waypoints, false);
  ASSERT_FALSE(manager.start({{{0, 0}, 0.0}, 70.0}));
  bool led = false;
  Vector3 p_W(0, 0, -70);
  for (int k = 0; k < 4000; ++k) {
    const auto& out = manager.step(p_W, 8.0);
    led = led || (out.segment.straight() && out.path.circle);
    p_W.head<2>() = out.segment.point_at(out.progress_m + 0.5);
    p_W.z() = -out.height_m;
    EXPECT_LT(std::abs(out.cross_track_m), 1.0);
  }
  EXPECT_TRUE(led);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
