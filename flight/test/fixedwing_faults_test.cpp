// SPDX-License-Identifier: BSD-3-Clause
// Faults on the fixed wing, held to docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

TEST(FixedWing, LandsWithoutRangeSensor) {
  Rig rig(fixedwing("default", {"range@0"}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_touchdown(rig, 40.0, 1.5);
}

TEST(FixedWing, BlockedPitot) {
  struct Blocked {
    std::uint64_t seed;  // of the sensors too: the tube reads its own offset
    double at_s;
  };
  for (const Blocked& b : {Blocked{1, 80.0},
                           {98, 115.98},
                           {198, 52.76},
                           {301, 114.14},
                           {305, 37.9},
                           {327, 137.87},
                           {333, 38.93}}) {
    FlightChoice choice = fixedwing("default", {fmt::format("pitot_blocked@{}", b.at_s)});
    choice.seed = b.seed;
    Rig rig(choice);
    rig.flight->run();
    EXPECT_TRUE(rig.completed()) << b.seed;
    expect_in_control(rig);
    expect_touchdown(rig, 40.0, 2.0);
  }
}

TEST(FixedWing, TwentySecondsWithoutGnss) {
  Rig rig(fixedwing("default", {"gnss@80:20"}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_in_control(rig);
  EXPECT_LE(record(rig).straight_total.rms(), 15.0);
}

TEST(FixedWing, APositionThatIsUnreliableIsSaid) {
  const auto notes = [](const std::vector<std::string>& faults) {
    Rig rig(fixedwing("default", faults));
    std::vector<std::string> texts;
    rig.flight->runner().set_notify([&](const FlightNote& note) {
      if (note.text.rfind("position ", 0) == 0 && note.source == "estimator")
        texts.push_back(note.text);
    });
    rig.flight->run();
    rig.flight->runner().set_notify(nullptr);
    return texts;
  };
  using Texts = std::vector<std::string>;
  EXPECT_EQ(notes({}), Texts{});
  EXPECT_EQ(notes({"gnss@80:100"}),
            (Texts{"position by dead reckoning", "position unreliable: 3 sigma above 15 m",
                   "position lost", "position aided", "position reliable again"}));
}

TEST(FixedWing, MotorOff) {
  Rig rig(fixedwing("default", {"motor0_dead@80"}));
  rig.flight->run();
  EXPECT_FALSE(rig.completed());
  EXPECT_EQ(rig.flight->runner().stage(), Stage::kDone);
  expect_in_control(rig);
  expect_touchdown(rig, 30.0, 2.0);
}

TEST(FixedWing, AileronsStuck) {
  for (const double at_s : {16.4, 80.0}) {  // just off the ground, and in a turn
    Rig rig(fixedwing("default", {fmt::format("servo0_stuck@{}", at_s)}));
    rig.flight->run();
    EXPECT_EQ(rig.flight->runner().stage(), Stage::kDone) << rig.flight->runner().failure();
    expect_touchdown(rig, 40.0, 2.0);
  }
}

TEST(FixedWing, ThreeSecondsWithoutLink) {
  Rig rig(fixedwing("default", {"link_cut@80:3"}));
  rig.run_until(80.0);
  const double before_m = rig.height_m();
  double most_m = 0.0;
  while (rig.flight->now() < at_s(80.115)) rig.flight->step();
  EXPECT_EQ(rig.firmware().command().primary_axes() & 0x3FU, 0x3FU);
  while (rig.flight->now() < at_s(83.0)) {
    rig.flight->step();
    most_m = std::max(most_m, std::abs(rig.height_m() - before_m));
  }
  EXPECT_LT(most_m, 15.0);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_in_control(rig);
}

/// On the runway it is at rest before it begins again, and the mission is flown.
TEST(FixedWing, ATakeOffThatLinkOrReceiverInterruptIsFlownFromRest) {
  struct Interrupted {
    const char* fault;
    const char* pilot;
    std::vector<std::string> overrides;
  };
  for (const Interrupted& run : {Interrupted{"link_cut@15:8", "hover", {}},
                                 {"link_cut@15:8", "idle", {}},
                                 {"rc_silence@15:10", "hover", {"firmware.FAILSAFE_OFFBRD=0"}}}) {
    FlightChoice choice = fixedwing("default", {run.fault});
    choice.pilot = run.pilot;
    choice.overrides = run.overrides;
    Rig rig(choice);
    rig.run_until(15.0);
    ASSERT_EQ(std::string(rig.flight->autonomy().phase), "takeoff");
    ASSERT_TRUE(rig.flight->truth().on_ground);
    int again = 0;
    rig.flight->runner().set_notify([&](const FlightNote& note) {
      if (note.text.find("takes off again") == std::string::npos) return;
      ++again;
      const sim::BodyState& body = rig.flight->truth().body;
      EXPECT_LT(body.v_B.norm(), 1.0) << run.fault;
      EXPECT_LT(body.p_W.head<2>().norm(), 300.0) << run.fault;
    });
    rig.flight->run();
    rig.flight->runner().set_notify(nullptr);
    EXPECT_EQ(again, 1) << run.fault;
    EXPECT_TRUE(rig.completed()) << run.fault << ": " << rig.flight->score().verdict;
  }
}

TEST(FixedWing, NoMoreLink) {
  Rig rig(fixedwing("default", {"link_cut@80"}));
  EXPECT_TRUE(rig.reach(Stage::kFailed));
  EXPECT_LE(sim::to_seconds(rig.flight->now()), 141.0);
  rig.flight->run();
  EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
}

/// Faults of sensors that a flight survives; the second: whether the position is held to a limit.
class SensorFaults : public ::testing::TestWithParam<std::pair<const char*, bool>> {};

TEST_P(SensorFaults, AreFlownThrough) {
  Rig rig(fixedwing("default", {GetParam().first}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_in_control(rig);
  if (GetParam().second) {
    EXPECT_LE(record(rig).straight_total.rms(), 15.0);
  }
  ASSERT_TRUE(record(rig).touchdown());
  EXPECT_LE(record(rig).touchdown()->sink_m_s, 2.0);
}

INSTANTIATE_TEST_SUITE_P(
    FixedWing, SensorFaults,
    ::testing::Values(
        std::pair{"mag@80", false}, std::pair{"baro@80", false},
        std::pair{"diff_pressure@80", false}, std::pair{"baro_step=5@80", false},
        std::pair{"mag_turned=30@80", false}, std::pair{"accel_step_x=0.3@80", true},
        std::pair{"accel_step_y=0.3@80", true}, std::pair{"accel_step_z=0.3@80", true},
        std::pair{"gyro_step_x=0.02@80", true}, std::pair{"gyro_step_y=0.02@80", true},
        std::pair{"gyro_step_z=0.02@80", true}, std::pair{"gnss_step=30@80", false},
        std::pair{"gnss_delay=0.5@80", false}, std::pair{"baro_step=50@80", false},
        std::pair{"mag_turned=180@80", false}, std::pair{"gyro_step_x=0.1@80", false},
        std::pair{"gyro_step_y=0.1@80", false}, std::pair{"gyro_step_z=0.1@80", false}));

}  // namespace
}  // namespace rosflight::flight::testing
