// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/flight_manager.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "autonomy/multirotor/test/flight.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

TEST(FlightManager, FliesTheDefaultMissionAndLands) {
  Flight flight;
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_TRUE(flight.output().landed);
  EXPECT_TRUE(flight.output().mission_done);
  ASSERT_EQ(flight.events_of(FlightEventType::kWaypointReached).size(),
            flight.mission.waypoints.size());
  for (const FlightEvent& event : flight.events_of(FlightEventType::kWaypointReached)) {
    EXPECT_LT(event.value, 0.5);  // the tolerance it waits for
  }
  EXPECT_LT(flight.tracking_rms_m(), 0.15);
  EXPECT_LT(flight.impact_m_s, 0.6);  // touchdown speed 0.35 and what the loops add
  EXPECT_LT(flight.plant.state().p_W.head<2>().norm(), 0.2);  // the last waypoint is over the start
  EXPECT_GT(flight.t_s, 35.0);
  EXPECT_LT(flight.t_s, 65.0);
}

TEST(FlightManager, FliesAtAnyControlRate) {
  for (const int rate_hz : {100, 200, 400}) {
    Flight flight;
    flight.rate_hz = rate_hz;
    flight.run(80.0);
    EXPECT_TRUE(flight.disarmed) << rate_hz;
    EXPECT_LT(flight.tracking_rms_m(), 0.2) << rate_hz;
  }
}

TEST(FlightManager, FliesInWindWithWeakMotorsAndSlowAttitude) {
  struct Case {
    double wind_m_s, thrust_scale, attitude_rad_s;
  };
  for (const Case& c :
       {Case{6.0, 1.0, 10.0}, Case{0.0, 0.8, 10.0}, Case{0.0, 1.2, 10.0}, Case{4.0, 0.9, 6.0}}) {
    Flight flight;
    flight.plant.config().wind_W = {0.8 * c.wind_m_s, -0.6 * c.wind_m_s, 0.0};
    flight.plant.config().thrust_scale = c.thrust_scale;
    flight.plant.config().attitude_frequency_rad_s = c.attitude_rad_s;
    flight.run(100.0);
    EXPECT_TRUE(flight.disarmed) << c.wind_m_s << " " << c.thrust_scale;
    EXPECT_EQ(flight.events_of(FlightEventType::kWaypointReached).size(),
              flight.mission.waypoints.size());
    EXPECT_LT(flight.tracking_rms_m(), 0.5);
    EXPECT_LT(flight.impact_m_s, 0.6);
  }
}

TEST(FlightManager, FliesWithItsOwnAttitudeLoops) {
  FlightConfig config = default_config(0.7, 98.0);
  config.controller.attitude_loops = AttitudeLoops::kAutonomy;
  Flight flight(config);
  flight.rate_hz = 400;
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.tracking_rms_m(), 0.2);
}

TEST(FlightManager, FliesLinearLegs) {
  FlightConfig config = default_config();
  config.path.interpolation = Interpolation::kLinear;
  Flight flight(config, "missions/square.yaml");
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_EQ(flight.events_of(FlightEventType::kWaypointReached).size(), 4U);
}

// Weak points 17, 18: the setpoint jumped when the mission began.
TEST(FlightManager, SetpointDoesNotJumpWhenTheMissionBegins) {
  Flight flight;
  bool seen = false;
  Vector3 last = Vector3::Zero();
  flight.run(30.0, [&] {
    const FlightOutput& out = flight.output();
    if (out.tracking) {
      const double far_m = seen ? (out.setpoint.p_W - last).norm()
                                : (out.setpoint.p_W - flight.plant.state().p_W).norm();
      EXPECT_LT(far_m, seen ? 5.0 * 1.01 / flight.rate_hz : 0.3);
      seen = true;
    }
    last = out.setpoint.p_W;
  });
  EXPECT_TRUE(seen);
}

// Weak point 38, 37: the place of take-off may be anywhere, the landing point lower or higher.
TEST(FlightManager, TakesOffFromAHillAndLandsOnLowerGround) {
  Flight flight(default_config(), "missions/square.yaml", PlantConfig{.ground_down_m = -1.0});
  flight.run(20.0);
  flight.plant.config().ground_down_m = 0.5;
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_NEAR(flight.plant.state().p_W.z(), 0.5, 1e-9);
  EXPECT_LT(flight.impact_m_s, 0.6);
}

TEST(FlightManager, LandsOnHigherGroundThanItStartedFrom) {
  Flight flight(default_config(), "missions/square.yaml");
  flight.run(20.0);
  flight.plant.config().ground_down_m = -1.5;
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.impact_m_s, 1.3);  // it has not slowed down yet: landing speed 1 m/s
}

/// Without drag, lag and integral the altitude is that of s^2 + kd s + kp: unit step responses in closed form.
TEST(FlightManager, AStepOfTheAltitudeIsAnsweredAsTheGainsSay) {
  struct Gains {
    double kp, kd, overshoot, peak_s;
  };
  const auto oscillator = [](double kp, double damping) {
    const double damped = std::sqrt(1.0 - damping * damping);
    return Gains{kp, 2.0 * damping * std::sqrt(kp), std::exp(-kPi * damping / damped),
                 kPi / (std::sqrt(kp) * damped)};
  };
  for (const Gains& gains : {oscillator(4.0, 0.4), oscillator(6.0, 0.6), oscillator(2.0, 0.3)}) {
    FlightConfig config = default_config();
    config.follower.vertical = {gains.kp, 0.0, gains.kd};
    Flight flight(config, "missions/hover.yaml", {.motor_lag_s = 1e-3, .drag_1_s = 0.0});
    while (!flight.output().tracking) flight.run(0.1);
    flight.run(12.0);
    ASSERT_TRUE(flight.output().tracking);
    const double before_m = flight.plant.state().p_W.z();
    const double asked_m = flight.output().setpoint.p_W.z();
    const double start_s = flight.t_s;
    flight.manager.set_altitude_offset(1.0);
    double peak_m = 0.0;
    double peak_s = 0.0;
    flight.run(5.0, [&] {
      const double risen_m = before_m - flight.plant.state().p_W.z();
      if (risen_m > peak_m) peak_s = flight.t_s - start_s;
      peak_m = std::max(peak_m, risen_m);
    });
    EXPECT_NEAR(flight.output().setpoint.p_W.z(), asked_m - 1.0, 1e-9);
    EXPECT_NEAR(peak_m, 1.0 + gains.overshoot, 0.02) << gains.kd;
    EXPECT_NEAR(peak_s, gains.peak_s, 0.05) << gains.kd;
  }
}

TEST(FlightManager, AnOffsetOfTheAltitudeEndsWithThePathAndMissesNoWaypoint) {
  Flight flight;
  flight.manager.set_altitude_offset(2.0);  // not before it flies its path
  while (!flight.output().tracking) flight.run(0.1);
  EXPECT_NEAR(flight.output().setpoint.p_W.z(), flight.plant.state().p_W.z(), 0.5);
  flight.manager.set_altitude_offset(2.0);
  flight.run(80.0);
  EXPECT_EQ(flight.events_of(FlightEventType::kWaypointReached).size(),
            flight.mission.waypoints.size());
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.impact_m_s, 0.6);
}

// Weak point 37: nobody could ask for a landing.
TEST(FlightManager, LandsWhereItIsWhenAsked) {
  Flight flight;
  flight.run(12.0);
  ASSERT_EQ(flight.output().phase, Phase::kOffboard);
  const Vector3 asked_at = flight.plant.state().p_W;
  flight.manager.request_land();
  flight.run(40.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_FALSE(flight.output().mission_done);
  EXPECT_LT((flight.plant.state().p_W - asked_at).head<2>().norm(), 1.0);
}

// Weak point 31: a repeated state stamp sent one tick of position hold at the take-off point.
TEST(FlightManager, RepeatedAndBackwardTimesChangeNothing) {
  Flight flight;
  flight.run(10.0);
  ASSERT_EQ(flight.output().phase, Phase::kOffboard);
  const FlightOutput before = flight.output();
  for (const double t : {flight.last_step_s, flight.last_step_s - 5.0, std::nan("")}) {
    const FlightOutput& after = flight.manager.step({t, flight.plant.state(), flight.status()});
    EXPECT_EQ(after.command.u, before.command.u);
    EXPECT_EQ(after.phase, Phase::kOffboard);
    EXPECT_EQ(after.events.count, 0U);
  }
  flight.run(80.0);
  EXPECT_TRUE(flight.disarmed);
}

// Weak points 30, 34, 39: what happens around the pilot.
TEST(FlightManager, PilotTakesOverFliesAwayAndGivesBack) {
  Flight flight;
  flight.run(8.0);
  ASSERT_EQ(flight.output().phase, Phase::kOffboard);
  const std::size_t waypoint = flight.output().waypoint;
  flight.override_word = 0x3;  // both switches
  flight.run(0.1);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
  EXPECT_FALSE(flight.output().tracking);
  // he flies it by hand: somewhere else, moving
  for (int k = 0; k < 500; ++k) {
    flight.plant.state().p_W = {-6.0 + 0.002 * k, 5.0, -6.0};
    flight.plant.state().v_W = {2.0, 0.0, 0.0};
    flight.run(0.002);
  }
  flight.override_word = 0;
  flight.run(0.5);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
  EXPECT_LT((flight.plant.state().p_W - Vector3(-5.0, 5.0, -6.0)).norm(),
            2.0);  // braking from 2 m/s
  flight.run(60.0);
  EXPECT_TRUE(flight.disarmed);
  const auto reached = flight.events_of(FlightEventType::kWaypointReached);
  EXPECT_EQ(reached.size(), flight.mission.waypoints.size());
  EXPECT_EQ(reached[waypoint].index, waypoint);  // the interrupted leg was flown to its end
  EXPECT_EQ(flight.events_of(FlightEventType::kPilotTookOver).size(), 1U);
  EXPECT_EQ(flight.events_of(FlightEventType::kPilotGaveBack).size(), 1U);
}

TEST(FlightManager, EndsAtTheLastWaypointOrGoesRound) {
  for (const AtEnd end : {AtEnd::kHold, AtEnd::kCycle}) {
    Flight flight(default_config(), "missions/square.yaml");
    flight.mission.at_end = end;
    flight.manager.set_mission(flight.mission);
    flight.run(70.0);
    EXPECT_FALSE(flight.disarmed);
    EXPECT_EQ(flight.output().phase, Phase::kOffboard);
    EXPECT_EQ(flight.output().mission_done, end == AtEnd::kHold);
    const auto reached = flight.events_of(FlightEventType::kWaypointReached);
    EXPECT_GE(reached.size(), end == AtEnd::kHold ? 4U : 7U);
    EXPECT_LE(reached.size(), end == AtEnd::kHold ? 4U : 99U);
  }
}

TEST(FlightManager, NewMissionInFlightIsFlownFromWhereItIs) {
  Flight flight;
  flight.run(9.0);
  ASSERT_EQ(flight.output().phase, Phase::kOffboard);
  flight.manager.set_mission(load_mission("missions/square.yaml", {}));
  Vector3 last = flight.output().setpoint.p_W;
  flight.run(70.0, [&] {
    if (flight.output().tracking) {
      EXPECT_LT((flight.output().setpoint.p_W - last).norm(), 6.0 / flight.rate_hz);
    }
    last = flight.output().setpoint.p_W;
  });
  EXPECT_TRUE(flight.disarmed);
}

TEST(FlightManager, DoesNotTakeOffAgainAfterItHasLanded) {
  Flight flight;
  flight.run(80.0);
  ASSERT_TRUE(flight.disarmed);
  flight.manager.step({flight.t_s, flight.plant.state(), flight.status()});
  flight.disarmed = false;  // armed again
  flight.run(5.0);
  EXPECT_LT(-flight.plant.state().p_W.z(), 0.01);
  EXPECT_EQ(flight.output().phase, Phase::kDisarmed);
  flight.manager.set_mission(flight.mission);
  flight.run(5.0);
  EXPECT_GT(-flight.plant.state().p_W.z(), 1.0);
}

TEST(FlightManager, TakeoffHeightOfTheMissionCounts) {
  Flight flight;
  flight.mission.takeoff_height_m = 6.0;
  flight.manager.set_mission(flight.mission);
  double hold_m = 0.0;
  flight.run(12.0, [&] {
    if (flight.output().phase == Phase::kPositionHold) hold_m = -flight.output().setpoint.p_W.z();
  });
  EXPECT_NEAR(hold_m, 6.0, 1e-9);
}

TEST(FlightManager, FirstStepSaysNothingDangerous) {
  Flight flight;
  const FlightOutput& out = flight.manager.step({123.0, flight.plant.state(), {.armed = true}});
  EXPECT_EQ(out.command.mode, FirmwareMode::kPassThrough);
  for (const float u : out.command.u) EXPECT_EQ(u, 0.0F);
}

TEST(FlightManager, SameInputsSameOutputs) {
  Flight a;
  Flight b;
  a.run(20.0);
  b.run(20.0);
  EXPECT_EQ(a.output().command.u, b.output().command.u);
  EXPECT_EQ(a.plant.state().p_W, b.plant.state().p_W);
}

TEST(FlightManager, RefusesWhatCannotBeFlown) {
  const Mission mission = load_mission("missions/square.yaml", {});
  EXPECT_THROW(FlightManager(default_config(), Mission{}), std::invalid_argument);
  FlightConfig heavy = default_config();
  heavy.controller.mass_kg = 7.0;
  EXPECT_THROW(FlightManager(heavy, mission), std::invalid_argument);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
