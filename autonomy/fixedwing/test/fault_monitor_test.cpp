// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/fault_monitor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::autonomy::fixedwing {
namespace {

StateEstimate good_state() {
  StateEstimate state;
  state.attitude = state.vertical = state.horizontal = state.heading = Quality::kGood;
  state.airspeed_m_s = 15.0;
  return state;
}

TEST(FaultMonitor, StateIsLostAfterTheGraceAndRegainedAtOnce) {
  FaultMonitor monitor;
  FlightEvents events;
  monitor.start(0.0);
  StateEstimate bad = good_state();
  bad.v_W.y() = std::nan("");
  EXPECT_FALSE(monitor.state_good(bad, 0.09, events));
  EXPECT_FALSE(monitor.state_lost());
  for (const double t_s : {0.11, 0.5}) EXPECT_FALSE(monitor.state_good(bad, t_s, events));
  EXPECT_TRUE(monitor.state_lost());
  ASSERT_EQ(events.count, 1U);
  EXPECT_EQ(events.list[0].type, FlightEventType::kStateLost);
  EXPECT_TRUE(monitor.state_good(good_state(), 0.6, events));
  EXPECT_FALSE(monitor.state_lost());
  EXPECT_EQ(events.list[1].type, FlightEventType::kStateRegained);
  EXPECT_FALSE(monitor.state_good(good_state(), 0.7, events, false)) << "the link is silent";
}

TEST(FaultMonitor, DeadReckonedPositionIsKnownForATime) {
  FaultMonitor monitor;
  FlightEvents events;
  const SafetyConfig config{.dead_reckoning_s = 30.0};
  monitor.start(0.0);
  StateEstimate state = good_state();
  EXPECT_TRUE(monitor.position_known(state, 10.0, config, events));
  state.horizontal = Quality::kDeadReckoned;
  EXPECT_TRUE(monitor.position_known(state, 39.9, config, events));
  EXPECT_EQ(events.count, 0U);
  for (const double t_s : {40.1, 41.0}) {
    EXPECT_FALSE(monitor.position_known(state, t_s, config, events));
  }
  EXPECT_EQ(events.count, 1U);
  EXPECT_TRUE(monitor.position_known(good_state(), 42.0, config, events));
}

// A glide at constant airspeed with the nose 5 degrees down and 1 m/s of sink: V_dot = 0, so the
// specific energy falls by 1 m/s. Braking by g/15 at 15 m/s in level flight is as much.
TEST(FaultMonitor, MotorIsOutIfFullThrottleLosesEnergy) {
  FlightConfig config;
  config.safety.motor_out_s = 3.0;
  config.safety.motor_out_m_s = 0.9;
  const double g = config.controller.airframe.gravity_m_s2;
  StateEstimate glide = good_state();
  glide.q_WB = Eigen::AngleAxisd(-5.0 * kRadPerDeg, Vector3::UnitY());
  glide.a_B.x() = g * std::sin(-5.0 * kRadPerDeg);
  glide.v_W.z() = 1.0;
  StateEstimate brakes = good_state();
  brakes.a_B.x() = -g / 15.0;
  for (const StateEstimate& state : {glide, brakes}) {
    FaultMonitor monitor;
    FlightEvents events;
    EXPECT_FALSE(monitor.motor_out(state, true, 2.9, config, events));
    EXPECT_FALSE(monitor.motor_out(state, false, 0.2, config, events)) << "throttle taken back";
    EXPECT_FALSE(monitor.motor_out(state, true, 2.9, config, events));
    EXPECT_TRUE(monitor.motor_out(state, true, 0.2, config, events));
    EXPECT_TRUE(monitor.motor_out(good_state(), true, 0.2, config, events)) << "it stays lost";
    EXPECT_EQ(events.count, 1U);
  }
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
