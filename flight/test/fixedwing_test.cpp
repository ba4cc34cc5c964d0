// SPDX-License-Identifier: BSD-3-Clause
// Flights of a fixed wing through the real firmware, on the estimate: missions, tails, and what a
// user asks of a flight. Faults: fixedwing_faults_test.cpp.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

class Missions : public ::testing::TestWithParam<const char*> {};

TEST_P(Missions, AreFlownFromTakeoffToLanding) {
  Rig rig(fixedwing(GetParam()));
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_tracked(rig);
  expect_in_control(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(FixedWing, Missions,
                         ::testing::Values("default", "hourglass_line", "hourglass_dubins",
                                           "climb_and_descent", "reference_fixedwing"));

/// The same aircraft with other tails, through the firmware's mixer; as shipped it has an inverted
/// V-tail.
struct Tail {
  const char* name;
  std::vector<std::string> overrides;
};
class Tails : public ::testing::TestWithParam<Tail> {};

TEST_P(Tails, FlyTheDefaultMission) {
  FlightChoice choice = fixedwing("default");
  choice.overrides = GetParam().overrides;
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_tracked(rig);
  expect_in_control(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(
    FixedWing, Tails,
    ::testing::Values(
        Tail{"plain",
             {"firmware.PRIMARY_MIXER=9",
              "surfaces.layout=[{output: 0, travel_deg: 40, aileron: 1}, "
              "{output: 1, travel_deg: 40, elevator: 1}, {output: 2, travel_deg: 40, rudder: 1}]"}},
        // No rudder at all. Custom mixer: PRI_MIXER_a_b takes entry a of a command to channel b.
        Tail{"elevons",
             {"firmware.PRIMARY_MIXER=11", "firmware.PRI_MIXER_OUT_0=1",
              "firmware.PRI_MIXER_OUT_1=1", "firmware.PRI_MIXER_OUT_4=2",
              "firmware.PRI_MIXER_PWM_0=50", "firmware.PRI_MIXER_PWM_1=50",
              "firmware.PRI_MIXER_PWM_4=50", "firmware.PRI_MIXER_0_4=1", "firmware.PRI_MIXER_3_0=1",
              "firmware.PRI_MIXER_3_1=-1", "firmware.PRI_MIXER_4_0=1", "firmware.PRI_MIXER_4_1=1",
              "surfaces.layout=[{output: 0, travel_deg: 40, aileron: 0.5, elevator: 0.5}, "
              "{output: 1, travel_deg: 40, aileron: -0.5, elevator: 0.5}]"}}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(FixedWing, TheAerosondeFliesItsCircuit) {
  FlightChoice choice = fixedwing("wide_circuit");
  choice.vehicle = "aerosonde";
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->runner().failure();
  expect_tracked(rig);
  EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
  EXPECT_GE(record(rig).lowest_airspeed_m_s, 18.0);
  expect_touchdown(rig, 15.0, 1.5);
}

TEST(FixedWing, RacetrackInWind) {
  FlightChoice choice = fixedwing("racetrack");
  choice.wind = "8,250";
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_tracked(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

TEST(FixedWing, ASetpointHoldsWhileThePlannedPathIsFollowed) {
  for (const std::vector<std::string>& faults : {std::vector<std::string>{}, {"gnss@80"}}) {
    Rig rig(fixedwing("default", faults));
    std::map<std::string_view, std::set<bool>> on_path;
    while (!rig.flight->finished()) {
      rig.flight->step();
      if (rig.flight->runner().stage() != Stage::kFly) continue;
      const GuidanceOutput& output = rig.flight->autonomy();
      if (output.phase == std::string_view("disarmed")) continue;
      on_path[output.phase].insert(output.on_path);
      if (!output.on_path || !faults.empty()) continue;
      ASSERT_LT((rig.flight->truth().body.p_W - output.setpoint.p_W).norm(), 20.0) << output.phase;
    }
    for (const auto& [phase, values] : on_path) {
      const bool planned =
          phase == "mission" || phase == "approach" || (phase == "flare" && faults.empty());
      EXPECT_EQ(values, std::set<bool>{planned}) << phase;
    }
  }
}

TEST(FixedWing, SuccessiveLoopsFlyTheSame) {
  FlightChoice choice = fixedwing("climb_and_descent");
  choice.overrides = {"autonomy.energy.longitudinal=successive_loops"};
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed());
  expect_tracked(rig);
}

TEST(FixedWing, SameSeedSameFlight) {
  double last_m[2] = {};
  for (double& north_m : last_m) {
    Rig rig(fixedwing("default"));
    rig.run_until(60.0);
    north_m = rig.flight->truth().body.p_W.x();
  }
  EXPECT_EQ(last_m[0], last_m[1]);
}

TEST(FixedWing, AMissionForAMultirotorIsRefusedByLine) {
  try {
    Rig rig(fixedwing("square"));
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("square.yaml:"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rosflight::flight::testing
