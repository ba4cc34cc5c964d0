// SPDX-License-Identifier: BSD-3-Clause
// What a flight does when its state is lost or its link is silent, and afterwards: docs/faults.md.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

void lose_state(StateEstimate& s) {
  s.v_W.x() = std::nan("");
}

void lose_attitude(StateEstimate& s) {
  s.attitude = Quality::kNone;
}

/// With what the flight controller sends, and its angles for what it is not commanded.
struct World : SmallWorld {
  World() : SmallWorld(hourglass()) { angle_hold = with_attitude = with_baro = true; }
  Phase phase() const { return manager.output().phase; }
  double bank_rad() const { return std::abs(RollPitch::of(plant.state().q_WB).roll_rad); }
  void cut_link(double seconds) {
    silent = true;
    run(seconds);
    silent = false;
  }
};

TEST(FixedWingGaps, ALostStateRepeatsTheCommandForAMomentThenItGlidesLevel) {
  World world;
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.run(10.0);
  world.look = lose_state;
  world.run(0.09);
  EXPECT_EQ(world.phase(), Phase::kMission);
  EXPECT_EQ(world.count(FlightEventType::kStateLost), 0);
  world.run(0.03);
  EXPECT_EQ(world.phase(), Phase::kGlide);
  EXPECT_EQ(world.count(FlightEventType::kStateLost), 1);
  EXPECT_EQ(world.count(FlightEventType::kGlidesLevel), 1);
  EXPECT_EQ(world.manager.output().command.ignore, 0);
  EXPECT_EQ(world.manager.output().command.u[0], 0.0F);
  EXPECT_FALSE(world.manager.output().tracking);
  world.run(3.0);
  EXPECT_LT(world.bank_rad(), 3.0 * kRadPerDeg);
}

TEST(FixedWingGaps, AStateThatIsBackInTimeLetsTheMissionGoOn) {
  for (const auto& lost : {lose_state, lose_attitude}) {
    World world;
    ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
    world.run(10.0);
    const std::size_t target = world.manager.output().waypoint;
    world.look = lost;
    world.run(5.0);
    world.look = nullptr;
    world.run(0.1);
    EXPECT_EQ(world.phase(), Phase::kMission);
    EXPECT_EQ(world.manager.output().waypoint, target);
    EXPECT_EQ(world.count(FlightEventType::kStateRegained), 1);
    world.run(500.0);
    EXPECT_TRUE(world.manager.output().mission_done);
    EXPECT_TRUE(world.manager.output().landed);
    EXPECT_EQ(world.count(FlightEventType::kLongGap), 0);
  }
}

TEST(FixedWingGaps, AStateThatIsLostForGoodEndsInASoftTouchdownAndOnTheGround) {
  struct Case {
    bool attitude, baro, range;
  };
  for (const Case& c :
       {Case{true, true, true}, Case{true, true, false}, Case{true, false, true},
        Case{true, false, false}, Case{false, true, true}, Case{false, false, false}}) {
    World world;
    world.with_attitude = c.attitude;
    world.with_baro = c.baro;
    world.with_range = c.range;
    ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
    world.run(5.0);
    world.look = lose_state;
    world.run(3.0);
    double bank_rad = 0.0;
    double slowest_m_s = 99.0;
    world.run(200.0, [&] {
      if (world.plant.on_ground()) return;
      bank_rad = std::max(bank_rad, world.bank_rad());
      slowest_m_s = std::min(slowest_m_s, world.plant.state().airspeed_m_s);
    });
    EXPECT_TRUE(world.manager.output().request_disarm) << c.attitude << c.baro << c.range;
    EXPECT_TRUE(world.plant.on_ground()) << c.attitude << c.baro << c.range;
    EXPECT_LT(world.plant.touchdown_m_s(), 2.0) << c.attitude << c.baro << c.range;
    EXPECT_LT(bank_rad, 5.0 * kRadPerDeg) << c.attitude << c.baro << c.range;
    EXPECT_GT(slowest_m_s, 10.5) << c.attitude << c.baro << c.range;
  }
}

TEST(FixedWingGaps, WithoutAnAttitudeTheSurfacesAreTheFlightControllersAndTheMotorIsOff) {
  World world;
  world.with_attitude = false;
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.look = lose_state;
  world.run(1.0);
  const FirmwareCommand& command = world.manager.output().command;
  EXPECT_EQ(command.ignore, kIgnoreAll - 1);
  EXPECT_EQ(command.u[0], 0.0F);
}

TEST(FixedWingGaps, AStateThatIsLostJustAboveTheGroundDoesNotMakeItGoAround) {
  World world;
  ASSERT_TRUE(world.run_until(Phase::kApproach, 500.0));
  while (world.height_m() > 6.0) world.run(0.02);
  world.look = lose_state;
  world.run(0.5);
  world.look = nullptr;
  world.run(0.02);
  EXPECT_EQ(world.phase(), Phase::kFlare);
  world.run(60.0);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(world.plant.touchdown_m_s(), 2.0);
}

TEST(FixedWingGaps, ATakeOffWithoutAStateIsGivenUp) {
  for (const double height_m :
       {-1.0, 0.0, 2.0}) {  // before it is armed, rolling, just off the ground
    World world;
    world.run(height_m < 0.0 ? 0.2 : 1.5);
    while (world.height_m() < height_m) world.run(0.02);
    world.look = lose_state;
    world.run(40.0);
    EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 1) << height_m;
    EXPECT_TRUE(world.manager.output().request_disarm) << height_m;
    EXPECT_TRUE(world.plant.on_ground()) << height_m;
  }
}

TEST(FixedWingGaps, WhileTheLinkIsSilentThePilotHasIt) {
  World world;
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  world.silent = true;
  world.run(0.5);
  EXPECT_EQ(world.manager.output().command.ignore, 0) << "commands may still arrive";
  world.run(0.5);
  EXPECT_EQ(world.manager.output().command.ignore, kIgnoreAll);
  EXPECT_EQ(world.count(FlightEventType::kGlidesLevel), 0);
}

TEST(FixedWingGaps, ALinkThatIsBackWithinTenSecondsLetsTheMissionGoOn) {
  for (const double gap_s : {0.3, 3.0, 9.9}) {
    World world;
    ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
    world.run(10.0);
    world.cut_link(gap_s);
    world.run(500.0);
    EXPECT_TRUE(world.manager.output().mission_done) << gap_s;
    EXPECT_TRUE(world.manager.output().landed) << gap_s;
    EXPECT_EQ(world.count(FlightEventType::kLongGap), 0) << gap_s;
  }
}

TEST(FixedWingGaps, ALinkThatIsBackLaterLetsItCircleReturnAndLand) {
  for (const double gap_s : {10.2, 25.0}) {
    World world;
    ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
    world.run(10.0);
    world.cut_link(gap_s);
    world.run(0.02);
    EXPECT_EQ(world.count(FlightEventType::kLongGap), 1) << gap_s;
    const Vector3 back_W = world.plant.state().p_W;
    double farthest_m = 0.0;
    world.run(GapWatch::kHold_s - 0.1, [&] {
      EXPECT_EQ(world.phase(), Phase::kLoiter) << gap_s;
      farthest_m = std::max(farthest_m, (world.plant.state().p_W - back_W).head<2>().norm());
    });
    EXPECT_LT(farthest_m, 110.0) << gap_s << ": the circle is 50 m wide";
    world.run(0.2);
    EXPECT_EQ(world.phase(), Phase::kReturn) << gap_s;
    world.run(300.0);
    EXPECT_TRUE(world.manager.output().landed) << gap_s;
    EXPECT_FALSE(world.manager.output().mission_done) << gap_s;
    EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 15.0) << gap_s;
  }
}

/// As a node that is not called without a state has it.
TEST(FixedWingGaps, AJumpOfTheTimeIsAGap) {
  World world;
  ASSERT_TRUE(world.run_until(Phase::kMission, 60.0));
  const double t_s = world.plant.time_s();
  world.manager.step({t_s + 11.0, world.plant.state(), world.status, {}});
  EXPECT_EQ(world.phase(), Phase::kLoiter);
}

/// A list of waypoints may come late.
TEST(FixedWingGaps, AGapBeforeTheTakeOffDoesNotMatter) {
  World world;
  world.run(0.4);
  Status armed = world.status;
  armed.armed = true;
  world.manager.step({12.0, world.plant.state(), armed, {}});
  EXPECT_EQ(world.phase(), Phase::kTakeoff);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 0);
}

TEST(FixedWingGaps, ALongGapInTheTakeOffRunGivesItUp) {
  World world;
  world.run(1.2);
  ASSERT_EQ(world.phase(), Phase::kTakeoff);
  world.plant.config().motor = 0.0;
  world.cut_link(12.0);
  world.run(15.0);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 1);
  EXPECT_TRUE(world.manager.output().request_disarm);
}

/// The pilot's throttle has carried it off the ground; the height of the start is not that of the first state.
TEST(FixedWingGaps, ATakeOffRunThatAGapHasEndedInTheAirIsFlownOn) {
  World world;
  world.run(2.5);
  ASSERT_EQ(world.phase(), Phase::kTakeoff);
  ASSERT_LT(world.height_m(), 1.0);
  world.plant.fly_from({100.0, 0.0, -25.0}, 0.0, 15.0);
  world.cut_link(12.0);
  ASSERT_GT(world.height_m(), 10.0);
  world.look = [](StateEstimate& s) { s.bridging = true; };
  world.run(0.2);
  world.look = nullptr;
  world.run(0.1);
  EXPECT_NE(world.phase(), Phase::kTakeoff);
  world.run(400.0);
  EXPECT_EQ(world.count(FlightEventType::kTakeoffFailed), 0);
  EXPECT_TRUE(world.manager.output().landed);
  EXPECT_LT(world.plant.touchdown_W().head<2>().norm(), 30.0);
}

/// Whatever is lost in whatever order: within two seconds something is decided, and every flight ends.
TEST(FixedWingGaps, RandomGapsAlwaysLeadToADecision) {
  constexpr double kDecided_s = 2.0;
  std::mt19937 random(12);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int number = 0; number < 15; ++number) {
    World world;
    world.with_attitude = share(random) < 0.7;
    world.with_baro = share(random) < 0.5;
    world.with_range = share(random) < 0.5;
    double changed_s = 0.0;
    bool lost = false;
    const auto check = [&] {
      const FlightOutput& out = world.manager.output();
      for (const float u : out.command.u) ASSERT_TRUE(std::isfinite(u)) << number;
      if (world.plant.time_s() - changed_s < kDecided_s || !world.status.armed) return;
      if (world.silent) {
        EXPECT_EQ(out.command.ignore, kIgnoreAll) << number;
      } else if (lost) {
        const bool down = out.phase == Phase::kGlide || out.phase == Phase::kLanded;
        EXPECT_TRUE(down) << number << " phase " << name(out.phase);
        EXPECT_EQ(out.command.u[0], 0.0F) << number;
        EXPECT_NE(out.command.ignore, kIgnoreAll) << number;
      } else {
        EXPECT_EQ(out.command.ignore, 0) << number;
      }
    };
    const int gaps = 1 + static_cast<int>(4.0 * share(random));
    for (int gap = 0; gap < gaps; ++gap) {
      world.run(0.2 + 60.0 * share(random) * share(random), check);
      lost = share(random) < 0.5;
      world.silent = !lost;
      if (lost) world.look = lose_state;
      changed_s = world.plant.time_s();
      world.run(0.05 * std::pow(1000.0, share(random)), check);
      world.silent = lost = false;
      world.look = nullptr;
      changed_s = world.plant.time_s();
    }
    world.run(590.0, check);
    EXPECT_TRUE(world.manager.output().request_disarm)
        << number << " phase " << name(world.phase());
    EXPECT_TRUE(world.plant.on_ground()) << number;
  }
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
