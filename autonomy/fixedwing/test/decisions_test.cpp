// SPDX-License-Identifier: BSD-3-Clause
// What a flight decides when something is lost: position, motor, receiver, battery, fence.
#include <gtest/gtest.h>

#include "autonomy/fixedwing/flight_manager.hpp"
#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

void lose_position(StateEstimate& s) {
  s.horizontal = Quality::kNone;
}

TEST(FixedWingDecisions, WithoutAPositionForGoodItComesDownAndFlares) {
  for (const bool with_range : {true, false}) {
    SmallWorld world(hourglass());
    world.with_range = with_range;
    ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
    world.look = lose_position;
    double bank = 0.0;
    double slowest = 99.0;
    world.run(300.0, [&] {
      if (world.plant.on_ground()) return;
      bank = std::max(bank, std::abs(RollPitch::of(world.plant.state().q_WB).roll_rad));
      slowest = std::min(slowest, world.plant.state().airspeed_m_s);
    });
    EXPECT_TRUE(world.manager.output().landed) << with_range;
    EXPECT_FALSE(world.manager.output().mission_done);
    EXPECT_LT(world.plant.touchdown_m_s(), 2.0) << with_range;
    EXPECT_LT(bank, 46.0 * kRadPerDeg);
    EXPECT_GT(slowest, 10.5);
  }
}

TEST(FixedWingDecisions, WithoutAnAidedHeightItComesDownAtOnceToTheRangeSensor) {
  SmallWorld world(hourglass());
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.look = [](StateEstimate& s) {
    s.horizontal = s.vertical = Quality::kNone;
    s.p_W.z() += 6.0;  // 6 m too low
  };
  world.run(1.0);
  EXPECT_EQ(world.manager.output().phase, Phase::kDescent);
  world.run(120.0);
  EXPECT_EQ(world.count(FlightEventType::kStateLost), 0);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(world.plant.touchdown_m_s(), 2.0);
}

/// A take-off run in which the receiver is lost; the failsafe command stops the motor.
struct BrokenOff : SmallWorld {
  BrokenOff() : SmallWorld(hourglass()) {
    run(1.5);
    EXPECT_EQ(manager.output().phase, Phase::kTakeoff);
  }
  void lose_receiver(double seconds) {
    status.failsafe = true;
    plant.config().motor = 0.0;
    run(seconds);
    status.failsafe = false;
    plant.config().motor = 1.0;
  }
};

TEST(FixedWingDecisions, ATakeOffThatTheFailsafeHasInterruptedForAMomentGoesOn) {
  BrokenOff world;
  world.lose_receiver(2.0);
  world.run(15.0);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 0);
  EXPECT_GT(world.height_m(), 10.0);
}

TEST(FixedWingDecisions, ATakeOffThatTheFailsafeBrokeOffOnTheGroundIsTriedAgainFromRest) {
  for (const double silent_s : {6.0, 9.5}) {
    BrokenOff world;
    world.lose_receiver(silent_s);
    const double back_s = world.plant.time_s();
    world.run(0.1);
    EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 1);
    EXPECT_EQ(world.manager.output().phase, Phase::kRollout);
    ASSERT_TRUE(world.run_until(Phase::kTakeoff, 30.0));
    EXPECT_GT(world.plant.time_s() - back_s, TakeoffRetry::kHealthy_s - 0.1);
    EXPECT_LT(world.plant.state().v_W.norm(), 1.0);
    EXPECT_EQ(world.count(FlightEventType::kTakeoffAgain), 1);
    world.run(500.0);
    EXPECT_TRUE(world.manager.output().mission_done);
    EXPECT_TRUE(world.manager.output().landed);
  }
}

TEST(FixedWingDecisions, ATakeOffThatIsInterruptedAgainStaysOnTheGround) {
  BrokenOff world;
  world.lose_receiver(8.0);
  world.run(0.1);
  ASSERT_TRUE(world.run_until(Phase::kTakeoff, 30.0));
  world.run(1.0);
  world.lose_receiver(8.0);
  world.run(30.0);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffAgain), 1);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 2);
  EXPECT_TRUE(world.manager.output().request_disarm);
}

TEST(FixedWingDecisions, ATakeOffIsNotTriedAgainBesideTheRunwayOrAfterALongInterruption) {
  for (const bool beside : {true, false}) {
    BrokenOff world;
    world.lose_receiver(beside ? 8.0 : 12.0);
    world.look = [beside](StateEstimate& s) {
      if (beside) s.p_W.y() += 8.0;
    };
    world.run(30.0);
    EXPECT_EQ(world.count(FlightEventType::kTakeoffAgain), 0) << beside;
    EXPECT_TRUE(world.manager.output().request_disarm) << beside;
  }
}

TEST(FixedWingDecisions, AMotorThatDoesNotTakeOffIsNotTriedAgain) {
  SmallWorld world(hourglass());
  world.plant.config().motor = 0.0;
  world.run(60.0);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 1);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffAgain), 0);
  EXPECT_TRUE(world.manager.output().request_disarm);
}

TEST(FixedWingDecisions, AFailsafeLeavesNothingInTheControllerBehind) {
  SmallWorld world(hourglass());
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.run(20.0);
  world.status.failsafe = true;
  // It flies level, whatever guidance commands, 30 m below the path.
  world.look = [](StateEstimate& s) {
    s.p_W.z() += 30.0;
    s.q_WB = Quaternion(Eigen::AngleAxisd(heading_of(s.q_WB), Vector3::UnitZ()));
    s.w_B.setZero();
  };
  world.run(10.0);
  EXPECT_EQ(world.count(FlightEventType::kAileronsLost), 0);
  EXPECT_LT(std::abs(world.manager.output().control.pitch_c_rad), 20.0 * kRadPerDeg);
  world.look = nullptr;
}

TEST(FixedWingDecisions, APositionThatIsBackInTimeLetsTheMissionGoOn) {
  SmallWorld world(hourglass());
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.look = lose_position;
  world.run(115.0);
  EXPECT_EQ(world.manager.output().phase, Phase::kLoiter);
  world.look = nullptr;
  world.run(500.0);
  EXPECT_TRUE(world.manager.output().mission_done);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 15.0);
}

TEST(FixedWingDecisions, APositionThatIsBackDuringTheDescentEndsIt) {
  SmallWorld world(hourglass());
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.look = lose_position;
  ASSERT_TRUE(world.run_until(Phase::kDescent, 130.0));
  world.run(15.0);
  world.look = nullptr;
  world.run(1.0);
  EXPECT_EQ(world.manager.output().phase, Phase::kMission);
}

TEST(FixedWingDecisions, AGlideWithinReachEndsAtTheLandingPoint) {
  for (const double at_s : {40.0, 60.0, 75.0, 95.0, 110.0, 130.0, 150.0}) {
    SmallWorld world(hourglass());
    world.run(at_s);
    // Near enough: of 70 m height some 500 m are left after the turns.
    if (world.plant.state().p_W.head<2>().norm() > 300.0) continue;
    world.plant.config().motor = 0.0;
    world.run(200.0);
    EXPECT_EQ(world.count(FlightEventType::kMotorOut), 1) << at_s;
    EXPECT_TRUE(world.manager.output().landed) << at_s;
    EXPECT_LT(world.plant.touchdown_m_s(), 2.0) << at_s;
    EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 30.0) << at_s;
  }
}

/// From 145 m away and 64 m high the shortest paths are too short by most of a turn. What a longer
/// one does not use up goes into airspeed, within its limit.
TEST(FixedWingDecisions, AGlideUsesUpHeightThatIsLeftOver) {
  SmallWorld world(hourglass());
  world.run(115.0);
  world.plant.config().motor = 0.0;
  world.run(10.0);
  double fastest_m_s = 0.0;
  world.run(190.0, [&] {
    if (world.plant.on_ground()) return;
    fastest_m_s = std::max(fastest_m_s, world.plant.state().airspeed_m_s);
  });
  EXPECT_LT(fastest_m_s, 1.4 * 14.0 + 0.5);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(world.plant.touchdown_m_s(), 1.5);
  EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 30.0);
}

TEST(FixedWingDecisions, TheFailsafeCommandIsNoDeadMotor) {
  SmallWorld world(hourglass());
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.run(30.0);
  const std::size_t target = world.manager.output().waypoint;
  world.status.failsafe = true;
  world.plant.config().motor = 0.0;
  world.run(6.0);
  EXPECT_EQ(world.count(FlightEventType::kMotorOut), 0);
  EXPECT_EQ(world.count(FlightEventType::kFailsafeFlies), 1);
  EXPECT_FALSE(world.manager.output().tracking);
  world.status.failsafe = false;
  world.plant.config().motor = 1.0;
  world.run(2.0);
  EXPECT_EQ(world.count(FlightEventType::kFailsafeOver), 1);
  EXPECT_EQ(world.manager.output().phase, Phase::kMission);
  EXPECT_EQ(world.manager.output().waypoint, target);
  EXPECT_EQ(world.count(FlightEventType::kPilotTookOver), 0);
}

FlightConfig with_battery() {
  FlightConfig config = default_config();
  config.battery.cells = 6.0;
  config.battery.capacity_Ah = 8.0;
  return config;
}

TEST(FixedWingDecisions, ALowBatteryReturnsAndLandsAnEmptyOneLandsAtOnce) {
  for (const double cell_V : {3.70, 3.60}) {
    SmallWorld world(hourglass(), {}, with_battery());
    world.status.battery_fresh = true;
    world.status.battery_voltage_V = 6.0 * 4.0;
    world.run(50.0);
    world.status.battery_voltage_V = 6.0 * cell_V;
    world.run(3.5);
    EXPECT_EQ(world.manager.output().phase, cell_V > 3.65 ? Phase::kReturn : Phase::kApproach);
    world.run(250.0);
    EXPECT_TRUE(world.manager.output().landed);
    EXPECT_FALSE(world.manager.output().mission_done);
    EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 15.0);
  }
}

TEST(FixedWingDecisions, AnotherMissionInFlightDoesNotFillTheBattery) {
  SmallWorld world(hourglass(), {}, with_battery());
  world.status.battery_fresh = true;
  world.status.battery_voltage_V = 6.0 * 4.0;
  world.run(50.0);
  world.status.battery_voltage_V = 6.0 * 3.70;
  world.run(3.5);
  ASSERT_EQ(world.manager.output().phase, Phase::kReturn);
  world.status.battery_voltage_V = 6.0 * 4.0;
  world.manager.set_mission(hourglass());
  world.run(250.0);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_FALSE(world.manager.output().mission_done);
}

TEST(FixedWingDecisions, AnotherMissionEndsAReturnThatWasAskedFor) {
  SmallWorld world(hourglass());
  world.run(60.0);
  world.manager.request_return();
  world.run(3.0);
  ASSERT_EQ(world.manager.output().phase, Phase::kReturn);
  world.manager.set_mission(hourglass());
  world.run(0.1);
  EXPECT_EQ(world.manager.output().phase, Phase::kMission);
  EXPECT_EQ(world.manager.output().waypoint, 0U);
  world.run(500.0);
  EXPECT_TRUE(world.manager.output().mission_done);
  EXPECT_TRUE(world.manager.output().landed);
}

TEST(FixedWingDecisions, OutsideOfItsFenceItReturnsAndLands) {
  Mission mission = hourglass();
  mission.fence = Fence{300.0, 120.0};
  SmallWorld world(mission);
  double farthest_m = 0.0;
  world.run(300.0, [&] {
    if (world.manager.output().phase == Phase::kApproach) return;  // its pattern is the mission's
    farthest_m = std::max(farthest_m, world.plant.state().p_W.head<2>().norm());
  });
  EXPECT_EQ(world.count(FlightEventType::kFenceCrossed), 1);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(farthest_m, 300.0 + 130.0);  // a turn of 50 m radius at 15 m/s, and half a second
  EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 15.0);
}

TEST(FixedWingDecisions, AboveItsFenceItReturnsInsideOfIt) {
  Mission mission = hourglass();
  mission.fence = Fence{1000.0, 58.0};  // the mission is at 70 m, a return at 60 m
  SmallWorld world(mission);
  ASSERT_TRUE(world.run_until(Phase::kReturn, 100.0));
  world.run(15.0);
  double highest_m = 0.0;
  world.run(300.0, [&] { highest_m = std::max(highest_m, world.height_m()); });
  EXPECT_LT(highest_m, 58.0);
  EXPECT_TRUE(world.manager.output().landed);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
