// SPDX-License-Identifier: BSD-3-Clause
// Flights of a fixed wing through the real firmware, on the estimate: docs/faults.md, section
// "Fixed wing", and what a user asks of a flight.
#include <gtest/gtest.h>

#include "apps/fly/test/flight_rig.hpp"

namespace rosflight::apps::testing {
namespace {

FlightChoice wing(const std::string& mission, std::vector<std::string> faults = {}) {
  FlightChoice choice = Rig::with_faults(std::move(faults));
  choice.vehicle = "anaconda";
  choice.mission = mission;
  return choice;
}

const WingRecord& record(const Rig& rig) {
  return *rig.flight->wing_record();
}

void expect_in_control(const Rig& rig) {
  EXPECT_LE(record(rig).roll.max_m, 60.0 * autonomy::kRadPerDeg);
  EXPECT_GE(record(rig).lowest_airspeed_m_s, 11.0);
}

void expect_touchdown(const Rig& rig, double within_m, double sink_m_s) {
  ASSERT_TRUE(record(rig).touchdown());
  EXPECT_LE(record(rig).touchdown()->distance_m, within_m);
  EXPECT_LE(record(rig).touchdown()->sink_m_s, sink_m_s);
}

void expect_tracked(const Rig& rig) {
  EXPECT_LE(record(rig).straight.rms_m(), 3.0);
  EXPECT_LE(record(rig).arc.rms_m(), 5.0);
  EXPECT_LE(record(rig).height.rms_m(), 2.0);
  EXPECT_LE(record(rig).airspeed.rms_m(), 1.0);
}

class Missions : public ::testing::TestWithParam<const char*> {};

TEST_P(Missions, AreFlownFromTakeoffToLanding) {
  Rig rig(wing(GetParam()));
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->director().failure();
  expect_tracked(rig);
  expect_in_control(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Wing, Missions,
                         ::testing::Values("default", "hourglass_line", "hourglass_dubins",
                                           "climb_and_descent", "reference_fixedwing"));

TEST(Wing, RacetrackInWind) {
  FlightChoice choice = wing("racetrack");
  choice.wind = "8,250";
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_tracked(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

TEST(Wing, SuccessiveLoopsFlyTheSame) {
  FlightChoice choice = wing("climb_and_descent");
  choice.overrides = {"autonomy.energy.longitudinal=successive_loops"};
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_tracked(rig);
}

TEST(Wing, LandsWithoutRangeSensor) {
  Rig rig(wing("default", {"range@0"}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_touchdown(rig, 40.0, 1.5);
}

TEST(Wing, BlockedPitot) {
  Rig rig(wing("default", {"pitot_blocked@80"}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_in_control(rig);
}

TEST(Wing, TwentySecondsWithoutGnss) {
  Rig rig(wing("default", {"gnss@80:20"}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_in_control(rig);
  EXPECT_LE(record(rig).straight_total.rms_m(), 15.0);
}

TEST(Wing, MotorOff) {
  Rig rig(wing("default", {"motor0_dead@80"}));
  rig.flight->run();
  EXPECT_FALSE(rig.completed());
  EXPECT_EQ(rig.flight->director().stage(), Stage::kDone);
  expect_in_control(rig);
  expect_touchdown(rig, 500.0, 2.0);
}

TEST(Wing, SameSeedSameFlight) {
  double last_m[2] = {};
  for (double& north_m : last_m) {
    Rig rig(wing("default"));
    rig.run_until(60.0);
    north_m = rig.flight->truth().body.p_N.x();
  }
  EXPECT_EQ(last_m[0], last_m[1]);
}

TEST(Wing, AMissionForAMultirotorIsRefusedByLine) {
  try {
    Rig rig(wing("square"));
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("square.yaml:"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rosflight::apps::testing
