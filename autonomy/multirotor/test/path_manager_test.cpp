// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/path_manager.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "autonomy/multirotor/angles.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

using Event = PathManager::Event;
constexpr double kStep_s = 0.01;

Waypoint go_to(const Vector3& p, double psi = 0.0, double speed = kInfinity) {
  return {.type = WaypointType::kGoto, .p_W = p, .psi_rad = psi, .speed_m_s = speed};
}

Waypoint hold(const Vector3& p, double seconds) {
  return {.type = WaypointType::kHold, .p_W = p, .hold_s = seconds};
}

Trajectory standing(const Vector3& p, double psi = 0.0) {
  Trajectory t;
  t.p_W = p;
  t.psi_rad = psi;
  return t;
}

PathConfig config() {
  return {.limits = {3.0, 5.0, 1.0, 2.0}, .waypoint_tolerance_m = 0.5, .arrival_timeout_s = 4.0};
}

/// A vehicle that is always where it should be.
struct PerfectFlight {
  explicit PerfectFlight(PathManager& manager, double start_s) : path(manager), t_s(start_s) {}

  const PathManager::Output& step() {
    t_s += kStep_s;
    out = path.step(t_s, p_W, psi_rad);
    p_W = out.setpoint.p_W;
    psi_rad = out.setpoint.psi_rad;
    return out;
  }
  /// Steps until an event; the time it took, or a negative number after 200 s.
  double until_event() {
    for (const double start_s = t_s; t_s < start_s + 200.0;) {
      if (step().event != Event::kNone) return t_s - start_s;
    }
    return -1.0;
  }

  PathManager& path;
  double t_s;
  Vector3 p_W{Vector3::Zero()};
  double psi_rad{};
  PathManager::Output out{};
};

// Weak point 17: the first leg began at NED zero with heading 0.
TEST(PathManager, FirstLegStartsWhereTheVehicleIs) {
  PathManager path(config());
  path.set_waypoints({go_to({30, 40, -12}, 1.0)});
  path.start(5.0, standing({20, 40, -10}, 0.7));
  const PathManager::Output first = path.step(5.0, {20, 40, -10}, 0.7);
  EXPECT_EQ(first.setpoint.p_W, Vector3(20, 40, -10));
  EXPECT_NEAR(first.setpoint.psi_rad, 0.7, 1e-12);
  const PathManager::Output next = path.step(5.0 + kStep_s, {20, 40, -10}, 0.7);
  EXPECT_LT((next.setpoint.p_W - first.setpoint.p_W).norm(), 1e-4);
}

// Weak point 17: after a clear the next mission began where the old one had last started.
TEST(PathManager, NewListInFlightLeadsOnFromTheSetpoint) {
  PathManager path(config());
  path.set_waypoints({go_to({50, 0, -10})});
  path.start(0.0, standing({0, 0, -10}));
  PerfectFlight flight(path, 0.0);
  for (int k = 0; k < 1000; ++k) flight.step();
  const Trajectory before = flight.out.setpoint;
  ASSERT_GT(before.v_W.norm(), 1.0);
  path.set_waypoints({go_to({20, 30, -10})});
  const Trajectory after = flight.step().setpoint;
  EXPECT_LT((after.p_W - before.p_W - before.v_W * kStep_s).norm(), 0.01);
  EXPECT_LT((after.v_W - before.v_W).norm(), 5.0 * 2.0 * kStep_s);  // one or two steps of a_max
}

// Weak point 18: the clock ran from the moment the waypoints arrived.
TEST(PathManager, ListGivenBeforeTheFlightWaitsForTheStart) {
  PathManager path(config());
  path.set_waypoints({go_to({20, 0, -2})});
  EXPECT_FALSE(path.started());
  path.start(100.0, standing({0, 0, -2}));
  EXPECT_TRUE(path.step(100.0, {0, 0, -2}, 0.0).setpoint.p_W.isApprox(Vector3(0, 0, -2)));
  EXPECT_NEAR(path.step(106.25, {10, 0, -2}, 0.0).setpoint.p_W.x(), 10.0, 1e-9);  // half of 12.5 s
}

// Weak point 19: zero-length legs gave NaN, heading-only legs were impossible.
TEST(PathManager, FliesLegsOfNoLengthAndPureTurns) {
  for (const Interpolation how : {Interpolation::kQuintic, Interpolation::kLinear}) {
    PathConfig c = config();
    c.interpolation = how;
    PathManager path(c);
    path.set_waypoints({go_to({0, 0, -2}), go_to({0, 0, -2}, 1.0), go_to({0, 0, -2}, 1.0)});
    path.start(0.0, standing({0, 0, -2}));
    PerfectFlight flight(path, 0.0);
    flight.p_W = {0, 0, -2};
    EXPECT_NEAR(flight.until_event(), 0.01, 1e-9);
    EXPECT_EQ(flight.out.event, Event::kReached);
    EXPECT_NEAR(flight.until_event(), 1.875, 0.011);  // 1 rad at 1 rad/s
    EXPECT_NEAR(flight.out.setpoint.psi_rad, 1.0, 1e-12);
    EXPECT_NEAR(flight.until_event(), 0.01, 1e-9);
    EXPECT_TRUE(flight.out.done);
    EXPECT_TRUE(std::isfinite(flight.out.setpoint.p_W.sum()));
  }
}

// Weak point 20: the end of a leg was never exactly the waypoint.
TEST(PathManager, WaitsExactlyInTheWaypoint) {
  PathManager path(config());
  path.set_waypoints({go_to({7.7, -1.3, -9.1}, 2.5)});
  path.start(0.0, standing({0, 0, -9}));
  const Trajectory s = path.step(50.0, {0, 0, 0}, 0.0).setpoint;
  EXPECT_EQ(s.p_W, Vector3(7.7, -1.3, -9.1));
  EXPECT_TRUE(s.v_W.isZero(0.0) && s.a_W.isZero(0.0));
  EXPECT_EQ(s.psi_dot_rad_s, 0.0);
}

// Weak point 21: a vehicle inside the tolerance switched before its leg was over, and the setpoint
// jumped.
TEST(PathManager, VehicleAheadOfTimeDoesNotEndTheLeg) {
  PathManager path(config());
  path.set_waypoints({go_to({20, 0, -2}), go_to({20, 20, -2})});
  path.start(0.0, standing({0, 0, -2}));
  Vector3 last(0, 0, -2);
  for (int k = 0; k < 1250; ++k) {
    const double t = k * kStep_s;
    const PathManager::Output out = path.step(t, {20, 0, -2}, 0.0);  // it sits in the target
    EXPECT_EQ(out.event, Event::kNone);
    EXPECT_EQ(out.waypoint, 0U);
    EXPECT_LE((out.setpoint.p_W - last).norm(), 3.0 * kStep_s + 1e-9);
    last = out.setpoint.p_W;
  }
  EXPECT_EQ(path.step(12.5 + kStep_s, {20, 0, -2}, 0.0).event, Event::kReached);
}

TEST(PathManager, VehicleBehindIsWaitedForWithinBothTolerances) {
  PathManager path(config());
  path.set_waypoints({go_to({20, 0, -2}), go_to({20, 20, -2})});
  path.start(0.0, standing({0, 0, -2}));
  EXPECT_EQ(path.step(12.6, {19.4, 0, -2}, 0.0).event, Event::kNone);  // 0.6 m away
  EXPECT_EQ(path.step(12.7, {19.6, 0, -2}, 0.3).event, Event::kNone);  // looks elsewhere
  EXPECT_EQ(path.step(12.75, {19.6, 0, -2}, -0.3).event, Event::kNone);
  const PathManager::Output out = path.step(12.8, {19.6, 0, -2}, 0.1);
  EXPECT_EQ(out.event, Event::kReached);
  EXPECT_EQ(out.event_waypoint, 0U);
  EXPECT_NEAR(out.event_distance_m, 0.4, 1e-9);
  EXPECT_EQ(out.waypoint, 1U);
}

TEST(PathManager, WaitingEndsWithAMissedWaypoint) {
  PathManager path(config());
  path.set_waypoints({go_to({20, 0, -2}), go_to({20, 20, -2})});
  path.start(0.0, standing({0, 0, -2}));
  EXPECT_EQ(path.step(16.4, {10, 0, -2}, 0.0).event, Event::kNone);
  const PathManager::Output out = path.step(16.6, {10, 0, -2}, 0.0);
  EXPECT_EQ(out.event, Event::kMissed);
  EXPECT_NEAR(out.event_distance_m, 10.0, 1e-9);
  EXPECT_EQ(out.waypoint, 1U);
}

// Weak point 21: hold time counted from entering the tolerance, before the leg was over.
TEST(PathManager, HoldTimeCountsFromTheArrival) {
  PathManager path(config());
  path.set_waypoints({hold({20, 0, -2}, 2.0), go_to({20, 20, -2})});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  flight.p_W = {20, 0, -2};
  EXPECT_NEAR(flight.until_event(), 12.5, 0.011);
  const double arrived_s = flight.t_s;
  while (flight.step().waypoint == 0) {
    ASSERT_LT(flight.t_s, arrived_s + 3.0);
  }
  EXPECT_NEAR(flight.t_s - arrived_s, 2.0, 0.011);
}

// Weak point 23: the hold timer ran on the wall clock and survived a clear.
TEST(PathManager, NewListForgetsARunningHold) {
  PathManager path(config());
  path.set_waypoints({hold({0, 0, -2}, 5.0), go_to({9, 0, -2})});
  path.start(0.0, standing({0, 0, -2}));
  EXPECT_EQ(path.step(0.01, {0, 0, -2}, 0.0).event, Event::kReached);
  path.step(4.9, {0, 0, -2}, 0.0);
  path.set_waypoints({hold({0, 0, -2}, 5.0), go_to({0, 9, -2})});
  EXPECT_EQ(path.step(4.95, {0, 0, -2}, 0.0).waypoint, 0U);
  EXPECT_EQ(path.step(9.9, {0, 0, -2}, 0.0).waypoint, 0U);
  EXPECT_EQ(path.step(10.0, {0, 0, -2}, 0.0).waypoint, 1U);
}

TEST(PathManager, HoldsIndefinitely) {
  PathManager path(config());
  path.set_waypoints(
      {Waypoint{.type = WaypointType::kHold, .p_W = {0, 0, -2}, .hold_indefinitely = true},
       go_to({9, 0, -2})});
  path.start(0.0, standing({0, 0, -2}));
  EXPECT_EQ(path.step(0.01, {0, 0, -2}, 0.0).event, Event::kReached);
  EXPECT_EQ(path.step(1e7, {0, 0, -2}, 0.0).waypoint, 0U);
}

// Weak point 24: the waypoint's speed was ignored in the default mode.
TEST(PathManager, SpeedOfTheWaypointLimitsItsLeg) {
  PathManager path(config());
  path.set_waypoints({go_to({15, 0, -2}, 0.0, 1.5), go_to({0, 0, -2}, 0.0, 99.0)});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  double fastest = 0.0;
  while (flight.step().event == Event::kNone)
    fastest = std::max(fastest, flight.out.setpoint.v_W.norm());
  EXPECT_NEAR(flight.t_s, 1.875 * 15.0 / 1.5, 0.011);
  EXPECT_NEAR(fastest, 1.5, 1e-4);
  EXPECT_NEAR(flight.until_event(), 1.875 * 15.0 / 3.0, 0.011);  // the path's own limit holds
}

TEST(PathManager, PositionVelocityAndAccelerationAreContinuousOverAMission) {
  PathManager path(config());
  path.set_waypoints({go_to({10, 0, -4}, 1.0), hold({10, 10, -5}, 1.0), go_to({0, 10, -5}, -2.0),
                      go_to({0, 0, -2})});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  flight.step();
  Trajectory last = flight.out.setpoint;
  while (!flight.out.done) {
    const Trajectory now = flight.step().setpoint;
    EXPECT_LE((now.p_W - last.p_W).norm(), 3.0 * kStep_s * 1.01);
    EXPECT_LE((now.v_W - last.v_W).norm(), 5.0 * kStep_s * 1.01);
    EXPECT_LE((now.a_W - last.a_W).norm(), 0.5);  // a jump would be of the size of a_max, 5
    last = now;
    ASSERT_LT(flight.t_s, 100.0);
  }
}

TEST(PathManager, StaysAtTheLastWaypointOrStartsOver) {
  for (const bool cycle : {false, true}) {
    PathConfig c = config();
    c.cycle = cycle;
    PathManager path(c);
    path.set_waypoints({go_to({3, 0, -2}), go_to({0, 0, -2})});
    path.start(0.0, standing({0, 0, -2}));
    PerfectFlight flight(path, 0.0);
    flight.until_event();
    flight.until_event();
    EXPECT_EQ(flight.out.event_waypoint, 1U);
    EXPECT_EQ(flight.out.done, !cycle);
    EXPECT_EQ(flight.step().waypoint, cycle ? 0U : 1U);
  }
}

TEST(PathManager, ACycleOfOneWaypointStaysThere) {
  PathConfig c = config();
  c.cycle = true;
  PathManager path(c);
  path.set_waypoints({go_to({3, 0, -2})});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  EXPECT_GT(flight.until_event(), 0.0);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(flight.step().event, Event::kNone);
  EXPECT_FALSE(flight.out.done);
}

TEST(PathManager, WithoutWaypointsStaysWhereItIs) {
  PathManager path(config());
  path.start(0.0, standing({3, 4, -5}, 1.0));
  const PathManager::Output out = path.step(10.0, {0, 0, 0}, 0.0);
  EXPECT_EQ(out.setpoint.p_W, Vector3(3, 4, -5));
  EXPECT_NEAR(out.setpoint.psi_rad, 1.0, 1e-12);
}

// Weak point 27: late joiners saw only the last ten waypoints. A list is one value here.
TEST(PathManager, KeepsAllOfALongList) {
  std::vector<Waypoint> list;
  list.reserve(40);
  for (int k = 0; k < 40; ++k) list.push_back(go_to({1.0 * k, 0, -2}));
  PathManager path(config());
  path.set_waypoints(list);
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  flight.p_W = {0, 0, -2};
  for (std::size_t k = 0; k < 40; ++k) {
    ASSERT_GT(flight.until_event(), 0.0);
    EXPECT_EQ(flight.out.event_waypoint, k);
    EXPECT_EQ(flight.out.event, Event::kReached);
  }
  EXPECT_TRUE(flight.out.done);
}

TEST(PathManager, ResumedLegStartsFromTheVehicleInMotion) {
  PathManager path(config());
  path.set_waypoints({go_to({20, 0, -2}), go_to({20, 20, -2})});
  path.start(0.0, standing({0, 0, -2}));
  path.step(3.0, {1, 0, -2}, 0.0);
  path.stop();
  Trajectory from = standing({5, 5, -3}, 1.0);
  from.v_W = {1.0, -1.0, 0.0};
  path.start(60.0, from);
  const Trajectory s = path.step(60.0, from.p_W, 1.0).setpoint;
  EXPECT_TRUE(s.p_W.isApprox(from.p_W));
  EXPECT_TRUE(s.v_W.isApprox(from.v_W));
}

TEST(PathManagerLinear, PassesWaypointsAtTheirSpeedAndStopsAtTheLast) {
  PathConfig c = config();
  c.interpolation = Interpolation::kLinear;
  PathManager path(c);
  path.set_waypoints(
      {go_to({12, 0, -2}, 0.0, 2.0), go_to({24, 0, -2}, 0.0, 2.0), go_to({36, 0, -2}, 0.0, 2.0)});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  EXPECT_NEAR(flight.until_event(), 12.0, 0.011);  // 0 to 2 m/s: 2 * 12/2
  EXPECT_NEAR(flight.out.setpoint.v_W.x(), 2.0, 1e-9);
  EXPECT_NEAR(flight.until_event(), 6.0, 0.011);
  EXPECT_NEAR(flight.until_event(), 12.0, 0.011);  // 2 to 0
  EXPECT_NEAR(flight.out.setpoint.v_W.x(), 0.0, 1e-9);
  EXPECT_TRUE(flight.out.done);
}

TEST(PathManagerLinear, LowersSpeedsThatTheNextLegCannotBrake) {
  PathConfig c = config();
  c.interpolation = Interpolation::kLinear;
  c.limits.acceleration_m_s2 = 1.0;
  PathManager path(c);
  path.set_waypoints({go_to({20, 0, -2}, 0.0, 3.0), go_to({22, 0, -2}, 0.0, 3.0)});
  path.start(0.0, standing({0, 0, -2}));
  PerfectFlight flight(path, 0.0);
  flight.until_event();
  // 2 m at 1 m/s^2 stop from 2 m/s
  EXPECT_NEAR(flight.out.setpoint.v_W.x(), 2.0, 0.02);
  while (!flight.out.done) {
    EXPECT_GE(flight.step().setpoint.a_W.x(), -1.0 - 1e-9);
    ASSERT_LT(flight.t_s, 60.0);
  }
}

TEST(PathManagerLinear, PassingTooFarAwayIsAMiss) {
  PathConfig c = config();
  c.interpolation = Interpolation::kLinear;
  PathManager path(c);
  path.set_waypoints({go_to({12, 0, -2}, 0.0, 2.0), go_to({24, 0, -2}, 0.0, 2.0)});
  path.start(0.0, standing({0, 0, -2}));
  const PathManager::Output out = path.step(12.01, {10, 0, -2}, 0.0);
  EXPECT_EQ(out.event, Event::kMissed);
  EXPECT_EQ(out.waypoint, 1U);
  EXPECT_NEAR(out.setpoint.p_W.x(), 12.0 + 2.0 * 0.01, 1e-3);  // the clock of the path did not wait
}

TEST(PathManager, OneMoreWaypointChangesNothingBeforeIt) {
  PathManager path(config());
  path.append(go_to({3, 0, -5}));  // the first of all
  path.start(0.0, standing({0, 0, -5}));
  PathManager same(config());
  same.set_waypoints({go_to({3, 0, -5})});
  same.start(0.0, standing({0, 0, -5}));
  path.append(go_to({3, 4, -5}));
  for (double t = 0.0; t < 1.0; t += kStep_s) {
    EXPECT_EQ(path.step(t, {0, 0, -5}, 0.0).setpoint.p_W,
              same.step(t, {0, 0, -5}, 0.0).setpoint.p_W);
  }
}

TEST(PathManager, APathThatWasDoneGoesOnToOneMoreWaypoint) {
  PathManager path(config());
  path.set_waypoints({go_to({3, 0, -5})});
  path.start(0.0, standing({0, 0, -5}));
  PerfectFlight flight(path, 0.0);
  flight.p_W = {0, 0, -5};
  ASSERT_GT(flight.until_event(), 0.0);
  EXPECT_TRUE(flight.step().done);
  path.append(go_to({3, 4, -5}));
  EXPECT_FALSE(flight.step().done);
  // From rest: max(1.875 d/v, sqrt(10/sqrt(3) d/a)) = max(2.5, 2.149) s for 4 m at 3 m/s, 5 m/s^2.
  EXPECT_NEAR(flight.until_event(), 2.5, 3.0 * kStep_s);
  EXPECT_EQ(flight.out.event_waypoint, 1U);
}

TEST(PathManager, ALowerSpeedLimitHoldsFromTheNextLegOn) {
  PathManager path(config());
  path.set_waypoints({go_to({8, 0, -5}), go_to({0, 0, -5})});
  path.start(0.0, standing({0, 0, -5}));
  PerfectFlight flight(path, 0.0);
  flight.p_W = {0, 0, -5};
  flight.step();
  PathConfig slow = config();
  slow.limits.speed_m_s = 1.0;
  path.configure(slow);
  EXPECT_NEAR(flight.until_event(), 1.875 * 8.0 / 3.0, 3.0 * kStep_s);
  EXPECT_NEAR(flight.until_event(), 1.875 * 8.0 / 1.0, 3.0 * kStep_s);
}

TEST(PathManager, StartsInTheSetpointOnlyWhenTheVehicleIsThere) {
  State state;
  state.p_W = {10, 0, -5};
  state.v_W = {0.3, 0, 0};
  EXPECT_EQ(path_start(state, 0.4, standing({10.5, 0, -5}, 7.0)).p_W, Vector3(10.5, 0, -5));
  EXPECT_NEAR(path_start(state, 0.4, standing({10.5, 0, -5}, 7.0)).psi_rad, 7.0 - 2.0 * kPi, 1e-12);
  EXPECT_EQ(path_start(state, 0.4, standing({12, 0, -5})).p_W, state.p_W);
  EXPECT_EQ(path_start(state, 0.4, standing({12, 0, -5})).v_W, state.v_W);
  state.v_W = {2, 0, 0};
  EXPECT_EQ(path_start(state, 0.4, standing({10.5, 0, -5})).v_W, state.v_W);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
