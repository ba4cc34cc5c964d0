// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/state_machine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace rosflight::autonomy::multirotor {
namespace {

using S = Conditions;
constexpr double kWeight = 34.335;

struct Bench {
  explicit Bench(const StateMachineConfig& c = {}) : machine(c, kWeight) {}
  StateMachine::Output step(double dt_s = 0.01) {
    t_s += dt_s;
    out = machine.step({.t_s = t_s,
                        .dt_s = dt_s,
                        .state = state,
                        .psi_rad = psi,
                        .armed = armed,
                        .pilot = pilot,
                        .ready = ready,
                        .command_good = good,
                        .land = land,
                        .thrust_N = thrust_N,
                        .planned = planned});
    return out;
  }
  void run(double seconds) {
    for (double end_s = t_s + seconds; t_s < end_s - 1e-9;) step();
  }
  /// Armed, up at the take-off height, holding.
  void take_off(double height_m = 2.0) {
    armed = true;
    step();
    state.p_W.z() -= height_m;
    step();
  }
  void to_offboard() {
    take_off();
    run(1.1);
  }

  StateMachine machine;
  State state{};
  double t_s{};
  double psi{};
  bool armed{}, pilot{}, ready{true}, good{true}, land{};
  double thrust_N{kWeight};
  const Trajectory* planned{};
  StateMachine::Output out{};
};

/// The same decisions once more, in words instead of rows.
Phase expected(Phase from, unsigned c) {
  const auto has = [c](unsigned which) { return (c & which) != 0; };
  if (!has(S::kArmed)) return Phase::kDisarmed;
  switch (from) {
    case Phase::kDisarmed:
      return has(S::kReady) && !has(S::kPilot) ? Phase::kTakeoff : from;
    case Phase::kTakeoff:
      if (has(S::kPilot)) return has(S::kLiftedOff) ? Phase::kPositionHold : from;
      if (has(S::kLandAsked)) return has(S::kLiftedOff) ? Phase::kLanding : Phase::kLanded;
      if (has(S::kHeightReached)) return Phase::kPositionHold;
      if (has(S::kTakeoffLate)) return has(S::kLiftedOff) ? Phase::kLanding : Phase::kLanded;
      return from;
    case Phase::kPositionHold:
      if (has(S::kTouched)) return Phase::kLanded;
      if (has(S::kPilot)) return from;
      if (has(S::kLandAsked)) return Phase::kLanding;
      if (has(S::kHoldOver) && has(S::kCommandGood)) return Phase::kOffboard;
      return has(S::kCommandLost) ? Phase::kLanding : from;
    case Phase::kOffboard:
      if (has(S::kPilot)) return Phase::kPositionHold;
      if (has(S::kLandAsked)) return Phase::kLanding;
      return has(S::kCommandGood) ? from : Phase::kPositionHold;
    case Phase::kLanding:
      if (has(S::kPilot)) return Phase::kPositionHold;
      return has(S::kTouched) ? Phase::kLanded : from;
    case Phase::kLanded:
      return from;
  }
  return from;
}

/// The flight controller's failsafe command brings the vehicle down; what comes after must not start
/// from the ground.
TEST(StateMachine, AFailsafeCommandThatLeadsToTheGroundEndsTheFlight) {
  StateMachineConfig config;
  for (const bool comes_down : {true, false}) {
    StateMachine machine(config, 34.0);
    State state;
    double t_s = 0.0;
    bool failsafe = false;
    const auto run = [&](double seconds) {
      for (long k = std::lround(seconds / 0.01); k > 0; --k, t_s += 0.01) {
        static_cast<void>(machine.step({.t_s = t_s,
                                        .dt_s = 0.01,
                                        .state = state,
                                        .armed = true,
                                        .pilot = failsafe,
                                        .ready = true,
                                        .command_good = true,
                                        .thrust_N = 34.0,
                                        .failsafe = failsafe}));
      }
    };
    run(0.1);
    state.p_W.z() = -2.0;
    run(10.0);
    ASSERT_EQ(machine.phase(), Phase::kOffboard);
    failsafe = true;
    run(1.0);
    EXPECT_EQ(machine.phase(), Phase::kPositionHold);
    state.p_W.z() = comes_down ? -0.02 : -1.5;
    run(0.5);
    failsafe = false;
    run(0.1);
    EXPECT_EQ(machine.phase(), comes_down ? Phase::kLanded : Phase::kPositionHold);
  }
}

/// The pilot's throttle stick brought it down while no state came; it does not start from there.
TEST(StateMachine, AGapThatEndsCloseToTheGroundEndsInALanding) {
  for (const double height_m : {0.4, 1.5}) {
    StateMachine machine(StateMachineConfig{}, 34.0);
    State state;
    StateMachine::Input in{.t_s = 0.0,
                           .dt_s = 0.01,
                           .state = state,
                           .armed = true,
                           .ready = true,
                           .command_good = true,
                           .thrust_N = 34.0};
    const auto run = [&](int steps) {
      for (int k = 0; k < steps; ++k, in.t_s += 0.01) static_cast<void>(machine.step(in));
    };
    run(10);
    state.p_W.z() = -2.0;
    run(1000);
    ASSERT_EQ(machine.phase(), Phase::kOffboard);
    state.p_W.z() = -height_m;
    state.v_W.z() = 0.4;
    in.pilot = in.regained = true;
    run(1);
    EXPECT_EQ(machine.phase(), Phase::kPositionHold);
    in.pilot = in.regained = false;
    run(10);
    EXPECT_EQ(machine.phase(), height_m < 1.0 ? Phase::kLanding : Phase::kPositionHold);
    run(60);
    state.p_W.z() = -0.4;
    run(10);
    EXPECT_EQ(machine.phase(), height_m < 1.0 ? Phase::kLanding : Phase::kPositionHold)
        << "of its own will";
  }
}

TEST(StateMachine, EveryPhaseUnderEveryCombinationOfConditions) {
  for (std::size_t phase = 0; phase < kPhaseTable.phases(); ++phase) {
    for (unsigned c = 0; c < 0x800; ++c) {
      const auto from = static_cast<Phase>(phase);
      ASSERT_EQ(kPhaseTable.next(from, static_cast<std::uint16_t>(c)), expected(from, c))
          << name(from) << " " << c;
    }
  }
}

TEST(StateMachine, WaitsForArmingWithIdleMotors) {
  Bench bench;
  EXPECT_TRUE(bench.step().idle);
  bench.armed = true;
  bench.ready = false;
  EXPECT_TRUE(bench.step().idle);
  bench.ready = true;
  bench.pilot = true;
  EXPECT_TRUE(bench.step().idle);
  bench.pilot = false;
  EXPECT_EQ(bench.step().phase, Phase::kTakeoff);
  EXPECT_TRUE(bench.out.changed);
}

// Weak point 38: on ground above the take-off height the climb never ended.
TEST(StateMachine, TakesOffRelativeToWhereItStands) {
  Bench bench;
  bench.state.p_W = {5, 6, -30};  // a hill of 30 m
  bench.psi = 0.7;
  bench.armed = true;
  bench.step();
  EXPECT_EQ(bench.out.command.mode, ControlMode::kNposEposDvelYaw);
  EXPECT_EQ(bench.out.command.cmd, (std::array<double, 4>{5, 6, -1, 0.7}));
  bench.state.p_W.z() = -31.9;
  bench.step();
  EXPECT_EQ(bench.out.phase, Phase::kPositionHold);
  EXPECT_EQ(bench.out.command.mode, ControlMode::kNposEposDposYaw);
  EXPECT_EQ(bench.out.command.cmd, (std::array<double, 4>{5, 6, -32, 0.7}));
}

// Weak point 44: heights went through an absolute value that may have been the integer one.
TEST(StateMachine, HeightsCountInFractionsOfAMetre) {
  Bench bench;
  bench.armed = true;
  bench.step();
  bench.state.p_W.z() = -0.14;
  EXPECT_TRUE(bench.step().level);
  bench.state.p_W.z() = -0.16;
  EXPECT_FALSE(bench.step().level);
  bench.state.p_W.z() = -1.79;
  EXPECT_EQ(bench.step().phase, Phase::kTakeoff);
  bench.state.p_W.z() = -1.81;
  EXPECT_EQ(bench.step().phase, Phase::kPositionHold);
}

// Weak point 36: the cut near the height of the origin acted in flight as well.
TEST(StateMachine, LevelOnlyWhileStillOnItsGround) {
  Bench bench;
  bench.state.p_W.z() = -10.0;
  bench.to_offboard();
  for (const double down : {0.1, 0.0, -0.1, 5.0}) {  // back at the height of the origin, and below
    bench.state.p_W.z() = down;
    EXPECT_FALSE(bench.step().level);
  }
}

TEST(StateMachine, TakeoffThatDoesNotRiseEndsOnTheGround) {
  Bench bench;
  bench.armed = true;
  bench.run(15.2);
  EXPECT_EQ(bench.machine.phase(), Phase::kLanded);
  EXPECT_TRUE(bench.out.request_disarm);
  EXPECT_TRUE(bench.out.idle);
}

TEST(StateMachine, TakeoffThatStallsInTheAirLands) {
  Bench bench;
  bench.armed = true;
  bench.step();
  bench.state.p_W.z() = -1.0;
  bench.run(15.2);
  EXPECT_EQ(bench.machine.phase(), Phase::kLanding);
}

TEST(StateMachine, HoldsThenFollows) {
  Bench bench;
  bench.take_off();
  EXPECT_EQ(bench.machine.phase(), Phase::kPositionHold);
  bench.run(0.95);
  EXPECT_EQ(bench.machine.phase(), Phase::kPositionHold);
  bench.run(0.1);
  EXPECT_EQ(bench.machine.phase(), Phase::kOffboard);
  EXPECT_TRUE(bench.out.follow);
}

TEST(StateMachine, FollowsOnlyOnceSettled) {
  Bench bench;
  bench.take_off();
  bench.state.v_W.x() = 1.0;
  bench.run(6.9);
  EXPECT_EQ(bench.machine.phase(), Phase::kPositionHold);
  bench.run(0.2);  // the hold of 1 s and the timeout of 6 s are over
  EXPECT_EQ(bench.machine.phase(), Phase::kOffboard);
}

// Weak point 34: with an invalid command the state flipped every tick and the command was flown
// anyway.
TEST(StateMachine, InvalidCommandHoldsWhereItWasWithoutChatter) {
  Bench bench;
  bench.to_offboard();
  ASSERT_EQ(bench.machine.phase(), Phase::kOffboard);
  bench.state.p_W = {40, 30, -8};
  bench.psi = 1.0;
  bench.good = false;
  bench.step();
  EXPECT_EQ(bench.out.phase, Phase::kPositionHold);
  EXPECT_FALSE(bench.out.follow);
  EXPECT_EQ(bench.out.command.cmd,
            (std::array<double, 4>{40, 30, -8, 1.0}));  // not the take-off point
  bench.good = true;
  int changes = 0;
  for (int k = 0; k < 300; ++k) {
    bench.good = k % 2 == 0;
    changes += bench.step().changed ? 1 : 0;
    EXPECT_FALSE(bench.out.follow && !bench.good);
    EXPECT_TRUE(k >= 98 || bench.out.phase == Phase::kPositionHold)
        << k;  // the hold time starts again
  }
  EXPECT_LE(changes, 6);  // back and forth at most once per hold time, not per tick
}

// Weak point 35: the last valid command was flown for ever.
TEST(StateMachine, CommandsExpire) {
  const StateMachine machine({}, kWeight);
  const ControllerCommand command{ControlMode::kNposEposDposYaw, {1, 2, 3, 4}, true};
  EXPECT_TRUE(machine.command_good(command, 0.0));
  EXPECT_TRUE(machine.command_good(command, 0.5));
  EXPECT_FALSE(machine.command_good(command, 0.51));
  EXPECT_FALSE(machine.command_good(command, -0.1));
}

TEST(StateMachine, BadCommandsAreNotGood) {
  const StateMachine machine({}, kWeight);
  ControllerCommand command{ControlMode::kNposEposDposYaw, {1, 2, 3, 4}, true};
  command.valid = false;
  EXPECT_FALSE(machine.command_good(command, 0.0));
  command.valid = true;
  command.cmd[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(machine.command_good(command, 0.0));
  command.cmd[2] = kInfinity;
  EXPECT_FALSE(machine.command_good(command, 0.0));
  command.cmd[2] = 0.0;
  // what a receiver that trusts the wire would make of an unknown mode
  const std::uint8_t unknown = 12;
  std::memcpy(&command.mode, &unknown, sizeof unknown);
  EXPECT_FALSE(machine.command_good(command, 0.0));
}

TEST(StateMachine, LongLossOfCommandsLands) {
  Bench bench;
  bench.to_offboard();
  bench.good = false;
  bench.run(29.0);
  EXPECT_EQ(bench.machine.phase(), Phase::kPositionHold);
  bench.run(1.5);
  EXPECT_EQ(bench.machine.phase(), Phase::kLanding);
}

TEST(StateMachine, PilotMovesTheHoldPointAndGivesBackToAHold) {
  Bench bench;
  bench.to_offboard();
  bench.pilot = true;
  bench.step();
  EXPECT_EQ(bench.out.phase, Phase::kPositionHold);
  bench.state.p_W = {9, 8, -7};
  bench.psi = -0.5;
  bench.run(5.0);
  EXPECT_EQ(bench.out.phase, Phase::kPositionHold);
  bench.pilot = false;
  bench.step();
  EXPECT_EQ(bench.out.command.cmd, (std::array<double, 4>{9, 8, -7, -0.5}));
  bench.run(0.9);
  EXPECT_EQ(bench.machine.phase(), Phase::kPositionHold);
  bench.run(0.2);
  EXPECT_EQ(bench.machine.phase(), Phase::kOffboard);
}

TEST(StateMachine, PilotOnTheGroundDelaysTheTakeoff) {
  Bench bench;
  bench.armed = true;
  bench.step();
  bench.pilot = true;
  bench.state.p_W = {1, 1, 0};
  bench.run(60.0);  // longer than the take-off may last
  EXPECT_EQ(bench.machine.phase(), Phase::kTakeoff);
  bench.pilot = false;
  EXPECT_EQ(bench.step().command.cmd, (std::array<double, 4>{1, 1, -1, 0}));
}

// Weak point 37: landing could not be reached, and its output was empty.
TEST(StateMachine, LandsWhereItIsPlannedAndAsksToBeDisarmed) {
  Bench bench;
  bench.to_offboard();
  Trajectory plan;
  plan.p_W = {0.1, 0.2, -2.0};
  plan.psi_rad = 0.3;
  bench.planned = &plan;
  bench.land = true;
  bench.step();
  EXPECT_EQ(bench.out.phase, Phase::kLanding);
  EXPECT_EQ(bench.out.command.mode, ControlMode::kNposEposDvelYaw);
  EXPECT_EQ(bench.out.command.cmd[0], 0.1);
  EXPECT_EQ(bench.out.command.cmd[1], 0.2);
  EXPECT_EQ(bench.out.command.cmd[3], 0.3);
  EXPECT_GT(bench.out.command.cmd[2], 0.0);
  bench.state.p_W.z() = 0.0;
  bench.thrust_N = 0.8 * kWeight;
  bench.run(5.0);
  EXPECT_EQ(bench.machine.phase(), Phase::kLanded);
  EXPECT_TRUE(bench.out.request_disarm);
  EXPECT_TRUE(bench.out.idle);
  bench.armed = false;
  EXPECT_EQ(bench.step().phase, Phase::kDisarmed);
  EXPECT_FALSE(bench.out.request_disarm);
}

TEST(StateMachine, LandingOffPlanStaysWhereItIs) {
  Bench bench;
  bench.to_offboard();
  bench.state.p_W = {7, 7, -4};
  bench.land = true;
  bench.step();
  EXPECT_EQ(bench.out.command.cmd[0], 7.0);
  EXPECT_EQ(bench.out.command.cmd[1], 7.0);
}

TEST(StateMachine, DisarmingEndsEverything) {
  for (int phase = 0; phase < 3; ++phase) {
    Bench bench;
    bench.armed = true;
    bench.step();
    if (phase > 0) bench.take_off();
    if (phase > 1) bench.to_offboard();
    bench.armed = false;
    EXPECT_EQ(bench.step().phase, Phase::kDisarmed);
    EXPECT_TRUE(bench.out.idle);
  }
}

TEST(StateMachine, NamesEveryPhase) {
  EXPECT_STREQ(name(Phase::kDisarmed), "disarmed");
  EXPECT_STREQ(name(Phase::kLanded), "landed");
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
