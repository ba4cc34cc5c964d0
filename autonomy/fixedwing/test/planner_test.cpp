// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/planner.hpp"

#include <gtest/gtest.h>

#include <random>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

Waypoint at(double n, double e, double h, Passing passing = Passing::kFillet,
            double course_deg = 0.0) {
  Waypoint wp;
  wp.p_W = {n, e, -h};
  wp.passing = passing;
  wp.course_rad = course_deg * kRadPerDeg;
  return wp;
}

/// The four waypoints of fixedwing_mission.yaml of ROSflight 2.x.
std::vector<Waypoint> hourglass(Passing passing) {
  return {at(400, -250, 70, passing, 66.0), at(-400, -50, 70, passing, 66.0),
          at(-400, -250, 70, passing, 66.0), at(400, -50, 70, passing, 66.0)};
}

/// Position and altitude go on without a step, and the course too but for corners.
void expect_smooth(const Plan& plan) {
  for (std::size_t k = 0; k < plan.segments.size(); ++k) {
    const bool last = k + 1 == plan.segments.size();
    if (last && plan.loop_to == Plan::kNoLoop) break;
    const Segment& a = plan.segments[k];
    const Segment& b = plan.segments[last ? plan.loop_to : k + 1];
    EXPECT_LT((a.point_at(a.length_m) - b.start.p_m).norm(), 1e-6) << "segment " << k;
    EXPECT_NEAR(a.height1_m, b.height0_m, 1e-9) << "segment " << k;
    EXPECT_NEAR(wrap_angle(a.course_at(a.length_m) + a.corner_rad - b.start.course_rad), 0.0, 1e-9)
        << "segment " << k;
  }
}

std::vector<const Segment*> arcs_of(const Plan& plan) {
  std::vector<const Segment*> out;
  for (const Segment& s : plan.segments) {
    if (!s.straight()) out.push_back(&s);
  }
  return out;
}

/// Figures worked out by hand for the shipped mission: corners of 75.96 degrees, so turns of
/// 104.04; the fillet begins 64.04 m before the waypoint and its centre is 81.25 m from it; left,
/// right, right, left.
TEST(Planner, FilletsOfTheShippedMission) {
  const Planner planner({.radius_m = 50.0});
  Plan plan;
  ASSERT_FALSE(planner.plan({}, hourglass(Passing::kFillet), true, 0, plan));
  expect_smooth(plan);
  ASSERT_NE(plan.loop_to, Plan::kNoLoop);
  const auto arcs = arcs_of(plan);
  ASSERT_GE(arcs.size(), 8U);
  const auto mission = hourglass(Passing::kFillet);
  const double senses[] = {-1, 1, 1, -1};
  for (const Segment* arc : arcs) {
    const std::size_t corner = arc->passes_waypoint ? arc->waypoint : (arc->waypoint + 3) % 4;
    const Vector2 w = mission[corner].p_W.head<2>();
    EXPECT_NEAR((arc->circle().centre_m - w).norm(), 81.25, 0.005);
    EXPECT_NEAR(arc->length_m, 0.5 * 50.0 * 104.04 * kRadPerDeg, 0.01);
    EXPECT_EQ(arc->radius_m > 0.0 ? 1.0 : -1.0, senses[corner]);
    if (arc->passes_waypoint) {
      EXPECT_NEAR((arc->start.p_m - w).norm(), 64.04, 0.005);
    }
  }
  // Legs of 824.62 and 200 m less two cuts of 64.04 m.
  for (const Segment& s : plan.segments) {
    if (!s.straight() || &s == plan.segments.data()) continue;
    const double whole = s.length_m + 2.0 * 64.04;
    EXPECT_TRUE(std::abs(whole - 824.62) < 0.02 || std::abs(whole - 200.0) < 0.02) << whole;
  }
}

/// Two fillets of 104.04 degrees share 200 m: R = 100/tan(52.018 deg), by hand. The long legs have
/// room for more.
TEST(Planner, FilletsAreAsWideAsTheirLegsHaveRoomFor) {
  for (const double wanted_m : {60.0, 78.0, 90.0}) {
    const Planner planner({.radius_m = wanted_m, .closest_m = 50.0});
    for (const std::size_t first : {0U, 1U}) {
      Plan plan;
      ASSERT_FALSE(planner.plan({}, hourglass(Passing::kFillet), true, first, plan));
      expect_smooth(plan);
      for (const Segment* arc : arcs_of(plan)) {
        EXPECT_NEAR(std::abs(arc->radius_m), std::min(wanted_m, 78.078), 0.01);
      }
    }
  }
  Plan plan;
  EXPECT_TRUE(Planner({.radius_m = 90.0}).plan({}, hourglass(Passing::kFillet), true, 0, plan));
}

TEST(Planner, LinesHaveCornersInTheWaypoints) {
  const Planner planner({.radius_m = 50.0});
  Plan plan;
  ASSERT_FALSE(planner.plan({}, hourglass(Passing::kLine), true, 0, plan));
  expect_smooth(plan);
  for (const Segment& s : plan.segments) {
    EXPECT_TRUE(s.straight());
    EXPECT_TRUE(s.passes_waypoint);
    EXPECT_NEAR(std::abs(s.corner_rad), 104.04 * kRadPerDeg, 1e-3);
  }
}

TEST(Planner, DubinsPassesEachPoseWithItsHeight) {
  const Planner planner({.radius_m = 50.0});
  auto list = hourglass(Passing::kDubins);
  list[1].p_W.z() = -90.0;
  Plan plan;
  ASSERT_FALSE(planner.plan(PathStart{{{0, 0}, 0.0}, 30.0}, list, true, 0, plan));
  expect_smooth(plan);
  int passed = 0;
  for (const Segment& s : plan.segments) {
    if (!s.passes_waypoint) continue;
    ++passed;
    const Waypoint& wp = list[s.waypoint];
    EXPECT_LT((s.point_at(s.length_m) - wp.p_W.head<2>()).norm(), 1e-6);
    EXPECT_NEAR(wrap_angle(s.course_at(s.length_m) - wp.course_rad), 0.0, 1e-9);
    EXPECT_NEAR(s.height1_m, -wp.p_W.z(), 1e-9);
  }
  EXPECT_EQ(passed, 6);  // four, and two of the second round
}

/// Point 20: the slope is the same on arcs and straights of a leg.
TEST(Planner, HeightChangesEvenlyOverTheWholeDubinsLeg) {
  const Planner planner({.radius_m = 50.0, .climb_slope = 0.2});
  Plan plan;
  ASSERT_FALSE(planner.plan(PathStart{{{0, 0}, 0.0}, 50.0},
                            std::vector{at(0, 300, 80, Passing::kDubins, 180.0)}, false, 0, plan));
  double length = 0.0;
  for (const Segment& s : plan.segments) length += s.length_m;
  ASSERT_GE(plan.segments.size(), 3U);
  for (const Segment& s : plan.segments) EXPECT_NEAR(s.slope(), 30.0 / length, 1e-12);
}

/// 100 m up within a way of 300 m at a slope of 0.15 needs 667 m: two turns of 314 m more.
TEST(Planner, SteepDubinsLegsWindUp) {
  const Planner planner({.radius_m = 50.0, .climb_slope = 0.15});
  Plan plan;
  ASSERT_FALSE(planner.plan(PathStart{{{0, 0}, 0.0}, 50.0},
                            std::vector{at(300, 0, 150, Passing::kDubins, 0.0)}, false, 0, plan));
  expect_smooth(plan);
  ASSERT_EQ(plan.segments.size(), 2U);
  EXPECT_NEAR(plan.segments[0].length_m, 2.0 * 2.0 * kPi * 50.0, 1e-9);
  EXPECT_NEAR(plan.segments[1].slope(), 100.0 / (300.0 + 200.0 * kPi), 1e-9);
}

TEST(Planner, FaultsNameTheWaypoint) {
  const Planner planner({.radius_m = 50.0, .climb_slope = 0.1, .descent_slope = 0.2});
  Plan plan;
  const auto fault = [&](std::vector<Waypoint> list) {
    const auto out = planner.plan({}, list, false, 0, plan);
    EXPECT_TRUE(plan.segments.empty() || !out);
    return out;
  };
  auto f = fault({at(0, 0, 50), at(300, 0, 50), at(330, 0, 50)});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kTooClose);
  EXPECT_EQ(f->waypoint, 2U);
  EXPECT_NEAR(f->found, 30.0, 1e-9);
  // A right angle needs 50 m on both sides of each corner: two corners, 80 m between them.
  f = fault({at(0, 0, 50), at(300, 0, 50), at(300, 80, 50), at(0, 80, 50)});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kTurn);
  EXPECT_EQ(f->waypoint, 2U);
  EXPECT_NEAR(f->found, 100.0, 1e-9);
  EXPECT_NEAR(f->allowed, 80.0, 1e-9);
  f = fault({at(0, 0, 50), at(300, 0, 50), at(0, 0, 50)});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kReversal);
  EXPECT_EQ(f->waypoint, 1U);
  f = fault({at(0, 0, 50), at(300, 0, 90)});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kTooSteep);
  EXPECT_NEAR(f->found, 40.0 / 300.0, 1e-9);
  f = fault({at(0, 0, 120), at(300, 0, 50)});
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kTooSteepDown);
  // No line crosses from one circle to another that overlaps it and turns the other way.
  std::vector<Waypoint> circles{at(0, 0, 50, Passing::kCircle), at(0, 80, 50, Passing::kCircle)};
  circles[0].turn = 1;
  circles[1].turn = -1;
  f = fault(circles);
  ASSERT_TRUE(f);
  EXPECT_EQ(f->kind, PlanFaultKind::kUnreachable);
}

/// Point 22: two fillets share the leg between them, each by the exact tangent length.
TEST(Planner, NeighbouringFilletsMayUseUpTheLegBetweenThem) {
  const Planner planner({.radius_m = 50.0});
  Plan plan;
  const std::vector<Waypoint> exact{at(0, 0, 50), at(300, 0, 50), at(300, 100, 50), at(0, 100, 50)};
  EXPECT_FALSE(planner.plan({}, exact, false, 0, plan));
  expect_smooth(plan);
}

/// Point 21: in a row of waypoints on one line there is no arc and no NaN.
TEST(Planner, CollinearWaypointsNeedNoArc) {
  const Planner planner({.radius_m = 50.0});
  Plan plan;
  for (const double course : {0.0, 0.3, 1.0, 2.0, 3.0}) {
    std::vector<Waypoint> list;
    for (int k = 0; k < 5; ++k) {
      const Vector2 p = 137.0 * k * along(course);
      list.push_back(at(p.x(), p.y(), 50));
    }
    ASSERT_FALSE(planner.plan({}, list, false, 0, plan));
    expect_smooth(plan);
    double length = 0.0;
    int passed = 0;
    for (const Segment& s : plan.segments) {
      length += s.length_m;
      passed += s.passes_waypoint ? 1 : 0;
      EXPECT_TRUE(std::isfinite(s.length_m));
    }
    EXPECT_NEAR(length, 548.0, 1e-6);
    EXPECT_EQ(passed, 4);
  }
}

TEST(Planner, CirclesAreEnteredAndLeftOnTangents) {
  const Planner planner({.radius_m = 60.0});
  Waypoint circle = at(500, 200, 80, Passing::kCircle);
  circle.turn = -1;
  circle.hold_s = 60.0;
  Plan plan;
  ASSERT_FALSE(planner.plan(PathStart{{{0, 0}, 0.0}, 80.0},
                            std::vector{at(300, 0, 80), circle, at(0, 500, 80)}, false, 0, plan));
  expect_smooth(plan);
  const Segment* arc = nullptr;
  for (const Segment& s : plan.segments) {
    if (s.length_m > 400.0 && !s.straight()) arc = &s;
  }
  ASSERT_NE(arc, nullptr);
  EXPECT_LT((arc->circle().centre_m - Vector2(500, 200)).norm(), 1e-6);
  EXPECT_LT(arc->radius_m, 0.0);
  EXPECT_GE(arc->length_m, 60.0 * 15.0);
  EXPECT_LT(arc->length_m, 60.0 * 15.0 + 2.0 * kPi * 60.0);
}

TEST(Planner, RandomMissionsAreSmoothOrRefused) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-400.0, 400.0);
  std::uniform_real_distribution<double> height(40.0, 100.0);
  std::uniform_int_distribution<int> kind(0, 3);
  const Planner planner({.radius_m = 50.0, .climb_slope = 0.3, .descent_slope = 0.3});
  int flown = 0;
  for (int k = 0; k < 300; ++k) {
    std::vector<Waypoint> list;
    for (int i = 0; i < 4; ++i) {
      list.push_back(at(place(random), place(random), height(random),
                        static_cast<Passing>(kind(random)), place(random)));
      list.back().turn = 1;
    }
    const bool cycle = k % 2 == 0;
    Plan plan;
    if (planner.plan(PathStart{{{0, 0}, 1.0}, 60.0}, list, cycle, 0, plan)) {
      EXPECT_TRUE(plan.segments.empty());
      continue;
    }
    ++flown;
    expect_smooth(plan);
    EXPECT_EQ(plan.loop_to != Plan::kNoLoop, cycle);
  }
  EXPECT_GT(flown, 60);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
