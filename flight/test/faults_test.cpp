// SPDX-License-Identifier: BSD-3-Clause
// Flies every row of docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr double kFault_s = 20.0;  // on the third leg, at 5 to 6 m, moving

const Rig& nominal() {
  static const std::unique_ptr<Rig> rig = [] {
    auto r = std::make_unique<Rig>(FlightChoice{});
    r->flight->run();
    return r;
  }();
  return *rig;
}

Rig flown(const std::string& fault) {
  Rig rig(Rig::with_faults({fault}));
  rig.flight->run();
  return rig;
}

/// What ROSflight 2.x does without a receiver, in place of what our vehicle files choose.
FlightChoice with_failsafe_command(const std::string& fault) {
  FlightChoice choice = Rig::with_faults({fault});
  choice.overrides = {"firmware.FAILSAFE_OFFBRD=0"};
  return choice;
}

/// Seconds from the fault until `condition`, looked at after every step; infinity if not within
/// `limit_s`.
template <class Condition>
double time_until(Rig& rig, double limit_s, Condition condition) {
  const double start_s = sim::to_seconds(rig.flight->now());
  while (sim::to_seconds(rig.flight->now()) < start_s + limit_s) {
    rig.flight->step();
    if (condition()) return sim::to_seconds(rig.flight->now()) - start_s;
  }
  return std::numeric_limits<double>::infinity();
}

bool outputs_sane(const Rig& rig) {
  const auto& outputs = rig.firmware().mixer().outputs();
  return std::all_of(outputs.begin(), outputs.end(),
                     [](float value) { return value >= 0.0F && value <= 1.0F; });
}

TEST(Faults, NominalFlightCompletes) {
  EXPECT_TRUE(nominal().completed());
  EXPECT_LT(nominal().flight->own_tracking().rms(), 0.4);
}

TEST(Faults, ShortImuGapIsBridged) {
  Rig rig(Rig::with_faults({"imu@20:0.09"}));
  bool error = false;
  rig.flight->set_script([&](Flight& flight, sim::Time) {
    error = error || flight.in_process().firmware().state().has(core::Error::kImuNotResponding);
  });
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  EXPECT_FALSE(error);
  EXPECT_LT(rig.flight->tracking().max, nominal().flight->tracking().max + 0.3);
}

TEST(Faults, ImuGapOfThreeTenthsIsFlownOnTheLastOutputs) {
  Rig rig(Rig::with_faults({"imu@20:0.3"}));
  rig.run_until(kFault_s);
  const auto& state = rig.firmware().state();
  EXPECT_LE(time_until(rig, 1.0, [&] { return state.has(core::Error::kImuNotResponding); }), 0.105);
  const float held = rig.firmware().mixer().outputs()[0];
  EXPECT_GT(held, 0.0F);
  while (sim::to_seconds(rig.flight->now()) < kFault_s + 0.295) {
    rig.flight->step();
    ASSERT_EQ(rig.firmware().mixer().outputs()[0], held);
  }
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
}

TEST(Faults, ImuGapStopsMotorsAndTheyTurnAgainWithTheFirstSample) {
  Rig rig(Rig::with_faults({"imu@20:0.4"}));
  rig.run_until(kFault_s);
  const auto& state = rig.firmware().state();
  EXPECT_LE(time_until(rig, 1.0, [&] { return state.has(core::Error::kImuNotResponding); }), 0.105);
  EXPECT_TRUE(state.armed());
  const auto motors_off = [&] { return rig.firmware().mixer().outputs()[0] == 0.0F; };
  time_until(rig, 0.22, motors_off);
  EXPECT_TRUE(motors_off()) << "325 ms after the last sample";
  rig.run_until(kFault_s + 0.4 + 0.005);
  EXPECT_FALSE(motors_off());
  EXPECT_FALSE(state.has(core::Error::kImuNotResponding));
}

/// Flies to the end: on the ground so soon after the fault, outputs within their limits all the time.
void expect_fall_within(Rig& rig, double limit_s) {
  bool sane = true;
  double down_s = 0.0;
  rig.flight->set_script([&](Flight& flight, sim::Time t) {
    sane = sane && outputs_sane(rig);
    if (down_s == 0.0 && sim::to_seconds(t) > kFault_s && flight.truth().on_ground)
      down_s = sim::to_seconds(t);
  });
  rig.flight->run();
  EXPECT_TRUE(sane);
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kFailed);
  EXPECT_GT(down_s, 0.0);
  EXPECT_LT(down_s, kFault_s + limit_s);
}

class ImuLost : public ::testing::TestWithParam<const char*> {};
TEST_P(ImuLost, FallsWithMotorsOffAndStaysArmed) {
  Rig rig(Rig::with_faults({std::string(GetParam()) + "@20"}));
  expect_fall_within(rig, 3.0);
  EXPECT_TRUE(rig.firmware().state().armed());
  EXPECT_EQ(rig.firmware().mixer().outputs()[0], 0.0F);
}
INSTANTIATE_TEST_SUITE_P(Kinds, ImuLost, ::testing::Values("imu", "imu_nan", "imu_stuck"));

TEST(Faults, AStuckImuIsNotRespondingAfterTwentySamples) {
  Rig rig(Rig::with_faults({"imu_stuck@20"}));
  rig.run_until(kFault_s);
  const auto& state = rig.firmware().state();
  // Twenty samples take 50 ms, silence another 100 ms.
  EXPECT_LE(time_until(rig, 1.0, [&] { return state.has(core::Error::kImuNotResponding); }), 0.155);
  const auto motors_off = [&] { return rig.firmware().mixer().outputs()[0] == 0.0F; };
  EXPECT_LE(time_until(rig, 1.0, motors_off), 0.225);
  EXPECT_TRUE(state.armed());
}

TEST(Faults, AfterASecondWithoutImuTheMotorsStayOffWhenItAnswers) {
  Rig rig(Rig::with_faults({"imu@20:1.5"}));
  rig.run_until(kFault_s + 1.0);
  float largest = 0.0F;
  rig.flight->set_script([&](Flight&, sim::Time) {
    largest = std::max(largest, rig.firmware().mixer().outputs()[0]);
  });
  rig.run_for(5.0);
  EXPECT_FALSE(rig.firmware().state().has(core::Error::kImuNotResponding));
  EXPECT_TRUE(rig.firmware().state().armed());
  EXPECT_EQ(largest, 0.0F);
}

TEST(Faults, FailsafeAtRestOnTheGroundStopsTheMotorsAfterThirtySeconds) {
  Rig rig(with_failsafe_command("rc_silence@20"));
  rig.run_until(kFault_s);
  ASSERT_LT(time_until(rig, 30.0, [&] { return rig.flight->truth().on_ground; }), 30.0);
  const auto running = [&] { return rig.firmware().mixer().outputs()[0] > 0.0F; };
  rig.run_for(25.0);
  EXPECT_TRUE(running()) << "rests for 25 s";
  EXPECT_LT(time_until(rig, 20.0, [&] { return !running(); }), 15.0);
  rig.run_for(5.0);
  EXPECT_FALSE(running());
}

TEST(Faults, DisarmedByMistakeInTheAirItArmsAgainAtOnce) {
  Rig rig(FlightChoice{});
  rig.run_until(kFault_s);
  using sim::rc::Control;
  // The pilot takes over, and touches the wrong switch.
  rig.flight->pilot().set_switch(Control::kAttitudeOverride, true);
  rig.flight->pilot().set_switch(Control::kThrottleOverride, true);
  rig.run_for(0.5);
  rig.flight->pilot().set_switch(Control::kArm, false);
  EXPECT_LT(time_until(rig, 1.0, [&] { return !rig.firmware().state().armed(); }), 0.15);
  EXPECT_EQ(rig.firmware().mixer().outputs()[0], 0.0F);
  rig.run_for(0.1);
  rig.flight->pilot().set_switch(Control::kArm, true);
  const auto flies = [&] {
    return rig.firmware().state().armed() && rig.firmware().mixer().outputs()[0] > 0.15F;
  };
  EXPECT_LT(time_until(rig, 1.0, flies), 0.03);
  rig.run_for(1.5);
  EXPECT_GT(rig.height_m(), 1.0);
  EXPECT_LT(rig.tilt_deg(), 15.0);
}

class OneSensorOfMany : public ::testing::TestWithParam<const char*> {};
TEST_P(OneSensorOfMany, IsDoneWithout) {
  Rig rig(Rig::with_faults({std::string(GetParam()) + "@20"}));
  std::uint16_t errors = 0;
  rig.flight->set_script([&](Flight& flight, sim::Time t) {
    if (sim::to_seconds(t) > kFault_s) errors |= flight.in_process().firmware().state().errors();
  });
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  EXPECT_EQ(errors, 0);
  EXPECT_LT(rig.flight->own_tracking().rms(), nominal().flight->own_tracking().rms() + 0.2);
}
INSTANTIATE_TEST_SUITE_P(Kinds, OneSensorOfMany,
                         ::testing::Values("mag", "baro", "diff_pressure", "range"));

class SizedFault : public ::testing::TestWithParam<const char*> {};
TEST_P(SizedFault, IsFlownThrough) {
  constexpr double kMaxTilt_deg = 45.0;
  constexpr double kMaxDrift_m = 30.0;
  Rig rig(Rig::with_faults({GetParam()}));
  double tilt_deg = 0.0;
  rig.flight->set_script([&](Flight& flight, sim::Time) {
    if (flight.runner().stage() == Stage::kFly) tilt_deg = std::max(tilt_deg, rig.tilt_deg());
  });
  rig.flight->run();
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kDone) << rig.flight->runner().failure();
  EXPECT_TRUE(rig.flight->autonomy().landed);
  EXPECT_LT(tilt_deg, kMaxTilt_deg);
  EXPECT_LT(rig.flight->own_tracking().max, kMaxDrift_m);
}
INSTANTIATE_TEST_SUITE_P(Kinds, SizedFault,
                         ::testing::Values("gnss@20:20", "gnss@20", "baro_step=5@20",
                                           "mag_turned=30@20", "accel_step_x=0.3@20",
                                           "accel_step_y=-0.3@20", "accel_step_z=0.3@20",
                                           "gyro_step_x=0.02@20", "gyro_step_y=-0.02@20",
                                           "gyro_step_z=0.02@20", "gnss_step=30@20",
                                           "gnss_delay=0.5@20", "baro_step=50@20",
                                           "mag_turned=180@20", "gyro_step_x=0.1@20",
                                           "gyro_step_y=0.1@20", "gyro_step_z=0.1@20"));

TEST(Faults, BatteryMonitorKeepsTheLastVoltage) {
  const Rig rig = flown("battery@20");
  EXPECT_TRUE(rig.completed());
  EXPECT_GT(rig.firmware().sensors().measurements().battery.voltage_V, 20.0F);
  EXPECT_NEAR(rig.flight->tracking().rms(), nominal().flight->tracking().rms(), 0.1);
}

struct RadioFault {
  const char* name;
  double failsafe_within_s;
};
class Radio : public ::testing::TestWithParam<RadioFault> {};

TEST_P(Radio, LossForTenSecondsChangesNothingWhileTheCompanionFlies) {
  Rig rig(Rig::with_faults({std::string(GetParam().name) + "@20:10"}));
  rig.run_until(kFault_s + 1.0);
  EXPECT_TRUE(rig.firmware().state().failsafe());
  EXPECT_FALSE(rig.firmware().command().in_failsafe());
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  EXPECT_NEAR(rig.flight->tracking().rms(), nominal().flight->tracking().rms(), 1e-3);
}

TEST_P(Radio, LossForTwoSecondsIsFailsafeThenTheMissionGoesOn) {
  Rig rig(with_failsafe_command(std::string(GetParam().name) + "@20:2"));
  rig.run_until(kFault_s);
  const auto& state = rig.firmware().state();
  EXPECT_LE(time_until(rig, 1.0, [&] { return state.failsafe(); }), GetParam().failsafe_within_s);
  EXPECT_TRUE(state.has(core::Error::kRcLost));
  double worst_sink = 0.0;
  double worst_tilt = 0.0;
  while (sim::to_seconds(rig.flight->now()) < kFault_s + 2.0) {
    rig.flight->step();
    worst_sink = std::max(worst_sink, rig.sink_m_s());
    if (sim::to_seconds(rig.flight->now()) > kFault_s + 1.5)
      worst_tilt = std::max(worst_tilt, rig.tilt_deg());
  }
  EXPECT_LT(worst_sink, 2.5);
  EXPECT_LT(worst_tilt, 10.0);
  rig.run_for(0.025);
  EXPECT_FALSE(state.failsafe());
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
}

TEST_P(Radio, LossForGoodSinksLevelToTheGround) {
  Rig rig(with_failsafe_command(std::string(GetParam().name) + "@20"));
  rig.run_until(kFault_s);
  double touch_sink = 0.0;
  double touch_tilt = 0.0;
  bool down = false;
  while (!rig.flight->runner().finished()) {
    if (!down) {
      touch_sink = rig.sink_m_s();
      touch_tilt = rig.tilt_deg();
    }
    rig.flight->step();
    down = down || rig.flight->truth().on_ground;
  }
  EXPECT_TRUE(down);
  EXPECT_LT(touch_sink, 3.0);
  EXPECT_LT(touch_tilt, 15.0);
  EXPECT_TRUE(rig.firmware().state().armed());
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kFailed);
}
// One receiver period (20 ms) and one step come on top of the timeout.
INSTANTIATE_TEST_SUITE_P(Kinds, Radio,
                         ::testing::Values(RadioFault{"rc_silence", 0.225},
                                           RadioFault{"rc_frame_loss", 0.125}));

/// OFFBOARD_HOLD [ms]: that of the vehicle file, and that of ROSflight 2.x.
class CutLink : public ::testing::TestWithParam<int> {};
TEST_P(CutLink, HandsOverToThePilotThenTheMissionGoesOn) {
  FlightChoice choice = Rig::with_faults({"link_cut@20:3"});
  choice.overrides = {fmt::format("firmware.OFFBOARD_HOLD={}", GetParam())};
  Rig rig(choice);
  rig.run_until(kFault_s);
  const auto& command = rig.firmware().command();
  const double height_m = rig.height_m();
  EXPECT_LE(time_until(rig, 1.0, [&] { return command.combined().value[3] == 0.0F; }), 0.115);
  EXPECT_EQ(command.offboard_active(), GetParam() > 0) << "level";
  EXPECT_LE(time_until(rig, 2.0, [&] { return !command.offboard_active(); }),
            1e-3 * GetParam() + 0.005);
  EXPECT_EQ(command.primary_axes() & 0x3FU, 0x3FU);
  rig.run_until(kFault_s + 3.0);
  EXPECT_LT(std::abs(rig.height_m() - height_m), 2.0);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
}
INSTANTIATE_TEST_SUITE_P(Holds, CutLink, ::testing::Values(1200, 0));

/// A second without commands, in each phase, with a pilot who only looks on.
class StalledCompanion : public ::testing::TestWithParam<double> {};
TEST_P(StalledCompanion, NeedsNoPilot) {
  FlightChoice choice = Rig::with_faults({fmt::format("companion_stall@{}:1", GetParam())});
  choice.pilot = "idle";
  Rig rig(choice);
  rig.flight->run();
  EXPECT_EQ(rig.flight->score().outcome, Outcome::kMissionDone) << rig.flight->score().verdict;
}
INSTANTIATE_TEST_SUITE_P(Moments, StalledCompanion, ::testing::Values(7.0, 8.0, 20.0, 26.5, 46.0));

/// Cut just after arming, when guidance commands the thrust of the take-off: idle as without OFFBOARD_HOLD.
TEST(Faults, ALinkCutBeforeLiftOffLeavesTheVehicleOnTheGround) {
  FlightChoice choice;
  choice.pilot = "idle";
  Rig armed(choice);
  ASSERT_TRUE(armed.reach(Stage::kFly));
  const double cut_s = sim::to_seconds(armed.flight->now()) + 0.05;
  for (const int duration_s : {3, 8}) {
    choice.faults = {fmt::format("link_cut@{:.4f}:{}", cut_s, duration_s)};
    Rig rig(choice);
    rig.run_until(cut_s);
    EXPECT_GT(rig.firmware().command().combined().value[2], 0.3F) << "it would lift off";
    const double stands_m = rig.height_m();
    double highest_m = stands_m;
    while (rig.flight->now() < at_s(cut_s + duration_s)) {
      highest_m = std::max(highest_m, rig.height_m());
      rig.flight->step();
    }
    EXPECT_LT(highest_m - stands_m, 0.05) << duration_s;
    rig.flight->run();
    EXPECT_EQ(rig.flight->score().outcome, Outcome::kMissionDone) << rig.flight->score().verdict;
  }
}

TEST(Faults, CutLinkForGoodEndsTheFlight) {
  Rig rig(Rig::with_faults({"link_cut@20"}));
  EXPECT_TRUE(rig.reach(Stage::kFailed));
  // In the pilot's hands it sinks slowly: the ground may be there before the flight is given up.
  const std::string why = rig.flight->runner().failure();
  EXPECT_TRUE(why == "link lost in flight" || why == "came down in flight") << why;
  EXPECT_LT(sim::to_seconds(rig.flight->now()), kFault_s + 61.0);
  rig.flight->run();
  EXPECT_EQ(rig.flight->score().outcome, Outcome::kLandedElsewhere) << rig.flight->score().verdict;
}

class Breakdown : public ::testing::TestWithParam<const char*> {};
TEST_P(Breakdown, RearmsInTheAirAndTheMissionGoesOn) {
  Rig rig(Rig::with_faults({std::string(GetParam()) + "@20"}));
  rig.run_until(kFault_s);
  const sim::Time boot = rig.flight->autopilot().boot_time();
  const double height_m = rig.height_m();
  rig.flight->step();
  EXPECT_GT(rig.flight->autopilot().boot_time(), boot);
  EXPECT_TRUE(rig.firmware().state().armed());
  rig.run_for(1.0);
  EXPECT_LT(rig.tilt_deg(), 30.0);
  EXPECT_NEAR(rig.height_m(), height_m, 1.5);
  const sim::Time only = rig.flight->autopilot().boot_time();
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  EXPECT_EQ(rig.flight->autopilot().boot_time(), only) << "once";
}
INSTANTIATE_TEST_SUITE_P(Kinds, Breakdown, ::testing::Values("crash", "hang"));

/// What a fault leads to is not a matter of the protocol: over lean the mission goes on as over
/// MAVLink, with nothing lost on the cable but what the fault takes.
class OverLean : public ::testing::TestWithParam<const char*> {};
TEST_P(OverLean, TheMissionGoesOnAfterTheFault) {
  auto choice = Rig::with_faults({GetParam()});
  choice.link_protocol = "lean";
  Rig rig(choice);
  bool sane = true;
  rig.flight->set_script([&](Flight&, sim::Time) { sane = sane && outputs_sane(rig); });
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  EXPECT_TRUE(sane);
}
INSTANTIATE_TEST_SUITE_P(Kinds, OverLean,
                         ::testing::Values("rc_silence@20:2", "imu@20:0.3", "link_cut@20:3",
                                           "crash@20"));

TEST(Faults, TouchingDownUnseenEndsTheLandingByTheRangeSensor) {
  Rig rig(Rig::with_faults({"gnss@47.6", "companion_stall@48.6:1"}));
  rig.flight->run();
  EXPECT_EQ(rig.flight->score().outcome, Outcome::kMissionDone) << rig.flight->score().verdict;
}

TEST(Faults, WeakMotorIsMadeUpFor) {
  const Rig rig = flown("motor1_partial=0.8@20");
  EXPECT_TRUE(rig.completed());
  EXPECT_LT(rig.flight->own_tracking().rms(), 0.6);
}

TEST(Faults, DeadMotorLosesTheVehicle) {
  Rig rig(Rig::with_faults({"motor3_dead@20"}));
  expect_fall_within(rig, 6.0);
}

}  // namespace
}  // namespace rosflight::flight::testing
