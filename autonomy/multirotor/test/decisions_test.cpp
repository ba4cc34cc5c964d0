// SPDX-License-Identifier: BSD-3-Clause
// What a flight decides when something is lost: position, receiver, battery, fence.
#include <gtest/gtest.h>

#include <optional>

#include "autonomy/multirotor/test/flight.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

FlightConfig with_battery() {
  FlightConfig config = default_config();
  config.battery.cells = 6.0;
  config.battery.capacity_Ah = 8.0;
  return config;
}

/// In the middle of its second leg.
struct Legs : Flight {
  explicit Legs(const FlightConfig& config = default_config()) : Flight(config) { run(14.0); }
  double from_start_m() const { return plant.state().p_W.head<2>().norm(); }
  int count(FlightEventType type) const { return static_cast<int>(events_of(type).size()); }
};

TEST(MultirotorDecisions, WithoutAPositionItKeepsLevelAndLandsWithinTwoSeconds) {
  Legs flight;
  ASSERT_EQ(flight.output().phase, Phase::kOffboard);
  flight.look = [](State& s) {
    s.horizontal = false;
    s.p_W.head<2>().setConstant(1e6);  // means nothing
    s.v_W.head<2>().setConstant(-50.0);
  };
  flight.run(0.05);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
  EXPECT_NEAR(flight.output().roll_rad, 0.0, 1e-9);
  EXPECT_NEAR(flight.output().pitch_rad, 0.0, 1e-9);
  flight.run(1.6);
  EXPECT_EQ(flight.output().phase, Phase::kLanding);
  EXPECT_EQ(flight.count(FlightEventType::kPositionLost), 1);
  flight.run(30.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.impact_m_s, 1.5);
}

TEST(MultirotorDecisions, APositionThatIsNotAidedIsHeldAndTheMissionGoesOnWhenItIs) {
  Legs flight;
  flight.look = [](State& s) { s.aided = false; };
  flight.run(20.0);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
  flight.look = nullptr;
  flight.run(FlightManager::kPositionSettles_s - 0.1);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold) << "the estimate still moves";
  flight.run(120.0);
  EXPECT_TRUE(flight.output().mission_done);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_EQ(flight.count(FlightEventType::kWaypointMissed), 0);
}

TEST(MultirotorDecisions, APositionThatIsBackWithinASecondLetsTheMissionGoOn) {
  Legs flight;
  flight.look = [](State& s) { s.horizontal = false; };
  flight.run(1.0);
  flight.look = nullptr;
  flight.run(120.0);
  EXPECT_TRUE(flight.output().mission_done);
  EXPECT_TRUE(flight.disarmed);
}

TEST(MultirotorDecisions, WhileTheFailsafeCommandFliesTheHoldPointFollows) {
  Legs flight;
  flight.failsafe = true;
  flight.run(2.0);
  EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
  EXPECT_EQ(flight.count(FlightEventType::kFailsafeFlies), 1);
  EXPECT_FALSE(flight.output().tracking);
  flight.failsafe = false;
  flight.run(120.0);
  EXPECT_EQ(flight.count(FlightEventType::kFailsafeOver), 1);
  EXPECT_EQ(flight.count(FlightEventType::kPilotTookOver), 0);
  EXPECT_TRUE(flight.output().mission_done);
}

TEST(MultirotorDecisions, AReturnClimbsGoesBackAndLands) {
  Legs flight;
  ASSERT_GT(flight.from_start_m(), 5.0);
  flight.manager.request_return();
  double lowest_m = 99.0;
  flight.run(60.0, [&] {
    if (flight.from_start_m() > 2.0) {
      lowest_m = std::min(lowest_m, -flight.plant.state().p_W.z());
    }
  });
  EXPECT_EQ(flight.count(FlightEventType::kReturning), 1);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.from_start_m(), 0.5);
  EXPECT_FALSE(flight.output().mission_done);
  EXPECT_EQ(flight.count(FlightEventType::kMissionDone), 0);
  EXPECT_GT(lowest_m, 3.0);
}

TEST(MultirotorDecisions, ALowBatteryReturnsAnEmptyOneLandsWhereItIs) {
  for (const double cell_V : {3.70, 3.60}) {
    Legs flight(with_battery());
    flight.battery_V = 6.0 * cell_V;
    const double before_m = flight.from_start_m();
    ASSERT_GT(before_m, 5.0);
    flight.run(60.0);
    EXPECT_TRUE(flight.disarmed);
    EXPECT_FALSE(flight.output().mission_done);
    if (cell_V > 3.65) {
      EXPECT_LT(flight.from_start_m(), 0.5);
    } else {
      EXPECT_GT(flight.from_start_m(), 2.0);
    }
    EXPECT_LT(flight.impact_m_s, 1.0);
  }
}

TEST(MultirotorDecisions, AnotherMissionInFlightDoesNotFillTheBattery) {
  Legs flight(with_battery());
  flight.battery_V = 6.0 * 3.70;
  flight.run(4.0);
  ASSERT_EQ(flight.count(FlightEventType::kBatteryReturn), 1);
  flight.battery_V = 6.0 * 4.0;  // without load, for a moment
  flight.manager.set_mission(flight.mission);
  flight.run(60.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_FALSE(flight.output().mission_done);
  EXPECT_LT(flight.from_start_m(), 0.5);
}

struct Fenced : Flight {
  explicit Fenced(const Fence& fence) {
    mission.fence = fence;
    manager.set_mission(mission);
  }
};

TEST(MultirotorDecisions, OutsideOfItsFenceItReturnsAndLands) {
  Fenced flight(Fence{8.0, 20.0});
  double farthest_m = 0.0;
  flight.run(60.0,
             [&] { farthest_m = std::max(farthest_m, flight.plant.state().p_W.head<2>().norm()); });
  EXPECT_EQ(flight.events_of(FlightEventType::kFenceCrossed).size(), 1U);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.plant.state().p_W.head<2>().norm(), 0.5);
  EXPECT_LT(farthest_m, 8.0 + 5.0);  // 4 m/s, half a second to be sure, and the way to brake
}

TEST(MultirotorDecisions, AboveItsFenceItReturnsInsideOfIt) {
  constexpr double kDown_s = 4.0;  // to turn and to come back below the top
  Fenced flight(Fence{100.0, 4.5});
  double highest_m = 0.0;
  std::optional<double> returned_s;
  flight.run(60.0, [&] {
    if (!returned_s && !flight.events_of(FlightEventType::kReturning).empty())
      returned_s = flight.t_s;
    if (returned_s && flight.t_s > *returned_s + kDown_s)
      highest_m = std::max(highest_m, -flight.plant.state().p_W.z());
  });
  EXPECT_TRUE(returned_s);
  EXPECT_LT(highest_m, 4.5);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.plant.state().p_W.head<2>().norm(), 0.5);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
