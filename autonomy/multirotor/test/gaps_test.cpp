// SPDX-License-Identifier: BSD-3-Clause
// What a flight does when its state is lost or its link is silent, and afterwards: docs/faults.md.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "autonomy/multirotor/test/flight.hpp"

namespace rosflight::autonomy::multirotor::test {
namespace {

void lose_state(State& s) {
  s.v_W.y() = std::nan("");
}

void lose_height(State& s) {
  s.vertical = false;
}

/// In the middle of its second leg, with what the flight controller sends.
struct Legs : Flight {
  Legs() {
    with_baro = with_accel = true;
    run(14.0);
  }
  double from_start_m() const { return plant.state().p_W.head<2>().norm(); }
  int count(FlightEventType type) const { return static_cast<int>(events_of(type).size()); }
  void cut_link(double seconds) {
    silent = true;
    run(seconds);
    silent = false;
  }
};

TEST(MultirotorGaps, ALostStateRepeatsTheCommandForAMomentThenItSinksLevel) {
  Legs flight;
  const FirmwareCommand last = flight.output().command;
  flight.look = lose_state;
  flight.run(0.09);
  EXPECT_EQ(flight.output().command.u, last.u);
  flight.run(0.03);
  EXPECT_EQ(flight.count(FlightEventType::kStateLost), 1);
  EXPECT_EQ(flight.count(FlightEventType::kSinksLevel), 1);
  EXPECT_EQ(flight.output().phase, Phase::kLanding);
  const FirmwareCommand& command = flight.output().command;
  EXPECT_EQ(command.ignore, 0);
  EXPECT_EQ(command.mode, FirmwareMode::kRollPitchYawrateThrottle);
  for (const std::size_t axis : {3U, 4U, 5U}) EXPECT_EQ(command.u[axis], 0.0F);
  EXPECT_GT(command.u[2], 0.1F);
}

TEST(MultirotorGaps, AStateThatIsBackInTimeLetsTheMissionGoOn) {
  for (const auto& lost : {lose_state, lose_height}) {
    Legs flight;
    flight.look = lost;
    flight.run(2.0);
    EXPECT_EQ(flight.output().phase, Phase::kLanding);
    flight.look = nullptr;
    flight.run(0.02);
    EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
    EXPECT_EQ(flight.count(FlightEventType::kStateRegained), 1);
    flight.run(120.0);
    EXPECT_TRUE(flight.output().mission_done);
    EXPECT_TRUE(flight.disarmed);
    EXPECT_EQ(flight.count(FlightEventType::kLongGap), 0);
  }
}

TEST(MultirotorGaps, AStateThatIsLostForGoodEndsOnTheGroundByAnyInstrument) {
  struct Case {
    bool baro, accel, range;
    double impact_m_s;
  };
  for (const Case& c :
       {Case{true, true, true, 0.6}, Case{true, true, false, 0.6}, Case{true, false, false, 0.8},
        Case{false, true, true, 1.5}, Case{false, true, false, 1.5}, Case{false, false, true, 1.3},
        Case{false, false, false, 1.3}}) {
    Legs flight;
    flight.with_baro = c.baro;
    flight.with_accel = c.accel;
    flight.with_range = c.range;
    flight.accel_bias_m_s2 = 0.03;
    flight.look = lose_state;
    flight.run(120.0);
    EXPECT_TRUE(flight.disarmed) << c.baro << c.accel << c.range;
    EXPECT_TRUE(flight.output().landed);
    EXPECT_TRUE(flight.plant.on_ground()) << c.baro << c.accel << c.range;
    EXPECT_LT(flight.impact_m_s, c.impact_m_s) << c.baro << c.accel << c.range;
  }
}

/// It has landed without a state: what comes back meanwhile starts nothing.
TEST(MultirotorGaps, AfterALandingWithoutAStateItStaysOnTheGround) {
  Legs flight;
  flight.look = lose_state;
  flight.run(60.0);
  ASSERT_TRUE(flight.disarmed);
  flight.disarmed = false;  // nobody did
  flight.look = nullptr;
  flight.run(0.02);
  EXPECT_TRUE(flight.output().request_disarm);
  EXPECT_EQ(flight.output().command.u[2], 0.0F);
  flight.disarmed = true;
  flight.manager.step({.t_s = flight.t_s + 0.01, .state = flight.plant.state()});
  EXPECT_EQ(flight.output().phase, Phase::kDisarmed);
  EXPECT_FALSE(flight.output().request_disarm);
}

TEST(MultirotorGaps, ATakeOffOnTheGroundWithoutAStateIsGivenUpWithinTwoSeconds) {
  for (const double at_s : {0.3, 0.6}) {  // before it is armed, and just after
    Flight flight;
    flight.run(at_s);
    flight.look = lose_state;
    flight.run(2.0);
    EXPECT_TRUE(flight.disarmed) << at_s;
    EXPECT_EQ(flight.events_of(FlightEventType::kTakeoffFailed).size(), 1U) << at_s;
    EXPECT_LT(-flight.plant.state().p_W.z(), 0.05) << at_s;
  }
}

TEST(MultirotorGaps, ATakeOffThatHasLeftTheGroundSinksBack) {
  Flight flight;
  flight.with_baro = flight.with_accel = true;
  flight.run(2.0);
  ASSERT_EQ(flight.output().phase, Phase::kTakeoff);
  ASSERT_GT(-flight.plant.state().p_W.z(), 0.5);
  flight.look = lose_state;
  flight.run(30.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_LT(flight.impact_m_s, 0.8);
}

TEST(MultirotorGaps, WhileTheLinkIsSilentThePilotHasIt) {
  Legs flight;
  flight.silent = true;
  flight.run(0.5);
  EXPECT_EQ(flight.output().command.ignore, 0) << "commands may still arrive";
  flight.run(0.5);
  EXPECT_EQ(flight.output().command.ignore, kIgnoreAll);
  EXPECT_EQ(flight.count(FlightEventType::kStateLost), 1);
  EXPECT_EQ(flight.count(FlightEventType::kSinksLevel), 0);
}

TEST(MultirotorGaps, ALinkThatIsBackWithinTenSecondsLetsTheMissionGoOn) {
  for (const double gap_s : {0.3, 3.0, 9.9}) {
    Legs flight;
    flight.cut_link(gap_s);
    flight.run(0.02);
    EXPECT_EQ(flight.output().phase, gap_s < 0.5 ? Phase::kOffboard : Phase::kPositionHold);
    flight.run(120.0);
    EXPECT_TRUE(flight.output().mission_done) << gap_s;
    EXPECT_TRUE(flight.disarmed) << gap_s;
    EXPECT_EQ(flight.count(FlightEventType::kLongGap), 0) << gap_s;
  }
}

TEST(MultirotorGaps, ALinkThatIsBackLaterLetsItHoldReturnAndLand) {
  for (const double gap_s : {10.2, 25.0, 55.0}) {
    Legs flight;
    flight.cut_link(gap_s);
    flight.run(0.02);
    EXPECT_EQ(flight.count(FlightEventType::kLongGap), 1) << gap_s;
    const Vector3 back_W = flight.plant.state().p_W;
    double farthest_m = 0.0;
    flight.run(GapWatch::kHold_s - 0.1, [&] {
      EXPECT_EQ(flight.output().phase, Phase::kPositionHold);
      farthest_m = std::max(farthest_m, (flight.plant.state().p_W - back_W).norm());
    });
    EXPECT_LT(farthest_m, 1.0) << gap_s;
    EXPECT_EQ(flight.count(FlightEventType::kReturning), 0) << gap_s;
    flight.run(0.2);
    EXPECT_EQ(flight.count(FlightEventType::kReturning), 1) << gap_s;
    flight.run(60.0);
    EXPECT_TRUE(flight.disarmed) << gap_s;
    EXPECT_FALSE(flight.output().mission_done) << gap_s;
    EXPECT_LT(flight.from_start_m(), 0.5) << gap_s;
    EXPECT_LT(flight.impact_m_s, 0.6) << gap_s;
  }
}

/// On the truth, or with an estimator that goes on by itself, the link decides alone.
TEST(MultirotorGaps, ASilentLinkIsAGapWhateverTheStateIs) {
  Legs flight;
  Status status = flight.status();
  const double begin_s = flight.last_step_s;
  for (int k = 1; k < 1200; ++k) {
    status.silent_s = 0.01 * k;
    flight.manager.step(
        {.t_s = begin_s + status.silent_s, .state = flight.plant.state(), .status = status});
  }
  EXPECT_EQ(flight.output().command.ignore, kIgnoreAll);
  status.silent_s = 0.0;
  const FlightOutput& out =
      flight.manager.step({.t_s = begin_s + 12.0, .state = flight.plant.state(), .status = status});
  EXPECT_EQ(out.events.list[out.events.count - 1].type, FlightEventType::kLongGap);
}

TEST(MultirotorGaps, AnotherMissionCancelsTheReturn) {
  Legs flight;
  flight.cut_link(15.0);
  flight.run(1.0);
  flight.manager.set_mission(flight.mission);
  flight.run(120.0);
  EXPECT_EQ(flight.count(FlightEventType::kReturning), 0);
  EXPECT_TRUE(flight.output().mission_done);
}

TEST(MultirotorGaps, ALongGapBeforeTheTakeOffEndsTheFlight) {
  Flight flight;
  flight.run(0.55);
  ASSERT_EQ(flight.output().phase, Phase::kTakeoff);
  flight.silent = true;
  flight.plant.config().mass_kg = 50.0;  // it stays on the ground
  flight.run(11.0);
  flight.silent = false;
  flight.run(2.0);
  EXPECT_TRUE(flight.disarmed);
  EXPECT_TRUE(flight.plant.on_ground());
}

/// Whatever is lost in whatever order: within two seconds something is decided, and every flight ends.
TEST(MultirotorGaps, RandomGapsAlwaysLeadToADecision) {
  constexpr double kDecided_s = 2.0;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int number = 0; number < 60; ++number) {
    Flight flight;
    flight.with_baro = share(random) < 0.5;
    flight.with_accel = share(random) < 0.5;
    flight.with_range = share(random) < 0.5;
    double changed_s = 0.0;
    bool lost = false;
    const auto check = [&] {
      const FlightOutput& out = flight.output();
      for (const float u : out.command.u) ASSERT_TRUE(std::isfinite(u)) << number;
      if (flight.t_s - changed_s < kDecided_s || !flight.armed()) return;
      if (flight.silent) {
        EXPECT_EQ(out.command.ignore, kIgnoreAll) << number;
      } else {
        const bool down = out.phase == Phase::kLanding || out.phase == Phase::kLanded;
        EXPECT_EQ(out.command.ignore, 0) << number;
        EXPECT_TRUE(!lost || down) << number << " phase " << name(out.phase);
      }
    };
    const int gaps = 1 + static_cast<int>(4.0 * share(random));
    for (int gap = 0; gap < gaps; ++gap) {
      flight.run(0.2 + 12.0 * share(random) * share(random), check);
      const double kind = share(random);
      flight.silent = kind < 0.5;
      if (kind >= 0.5) flight.look = kind < 0.75 ? lose_state : lose_height;
      lost = kind >= 0.5;
      changed_s = flight.t_s;
      flight.run(0.05 * std::pow(1000.0, share(random)), check);
      flight.silent = lost = false;
      flight.look = nullptr;
      changed_s = flight.t_s;
    }
    flight.run(150.0, check);
    EXPECT_TRUE(flight.disarmed) << number << " phase " << name(flight.output().phase);
    EXPECT_LT(-flight.plant.state().p_W.z(), 0.05)
        << number << flight.with_baro << flight.with_accel << flight.with_range;
    EXPECT_LT(flight.impact_m_s, 1.5)
        << number << flight.with_baro << flight.with_accel << flight.with_range;
  }
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor::test
