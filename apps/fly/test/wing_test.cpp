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

/// The same aircraft with other tails, through the firmware's mixer; as shipped it has an inverted
/// V-tail.
struct Tail {
  const char* name;
  std::vector<std::string> overrides;
};
class Tails : public ::testing::TestWithParam<Tail> {};

TEST_P(Tails, FlyTheDefaultMission) {
  FlightChoice choice = wing("default");
  choice.overrides = GetParam().overrides;
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->director().failure();
  expect_tracked(rig);
  expect_in_control(rig);
  expect_touchdown(rig, 15.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(
    Wing, Tails,
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

TEST(Wing, TheAerosondeFliesItsCircuit) {
  FlightChoice choice = wing("wide_circuit");
  choice.vehicle = "aerosonde";
  Rig rig(choice);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->director().failure();
  expect_tracked(rig);
  EXPECT_LE(record(rig).roll.max_m, 60.0 * autonomy::kRadPerDeg);
  EXPECT_GE(record(rig).lowest_airspeed_m_s, 18.0);
  expect_touchdown(rig, 15.0, 1.5);
}

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

TEST(Wing, ThreeSecondsWithoutLink) {
  Rig rig(wing("default", {"link_cut@80:3"}));
  rig.run_until(80.0);
  const double before_m = rig.height_m();
  double most_m = 0.0;
  while (rig.flight->now() < at_s(80.115)) rig.flight->step();
  EXPECT_EQ(rig.firmware().command().primary_entries() & 0x3FU, 0x3FU);
  while (rig.flight->now() < at_s(83.0)) {
    rig.flight->step();
    most_m = std::max(most_m, std::abs(rig.height_m() - before_m));
  }
  EXPECT_LT(most_m, 15.0);
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->director().failure();
  expect_in_control(rig);
}

TEST(Wing, NoMoreLink) {
  Rig rig(wing("default", {"link_cut@80"}));
  rig.flight->run();
  EXPECT_EQ(rig.flight->director().stage(), Stage::kFailed);
  EXPECT_LE(seconds(rig.flight->now()), 95.0);
  EXPECT_LE(record(rig).roll.max_m, 60.0 * autonomy::kRadPerDeg);
}

/// Faults of sensors that a flight survives; the second: whether the place is held to a limit.
class SensorFaults : public ::testing::TestWithParam<std::pair<const char*, bool>> {};

TEST_P(SensorFaults, AreFlownThrough) {
  Rig rig(wing("default", {GetParam().first}));
  rig.flight->run();
  EXPECT_TRUE(rig.completed()) << rig.flight->director().failure();
  expect_in_control(rig);
  if (GetParam().second) {
    EXPECT_LE(record(rig).straight_total.rms_m(), 15.0);
  }
  ASSERT_TRUE(record(rig).touchdown());
  EXPECT_LE(record(rig).touchdown()->sink_m_s, 2.0);
}

INSTANTIATE_TEST_SUITE_P(Wing, SensorFaults,
                         ::testing::Values(std::pair{"mag@80", false}, std::pair{"baro@80", false},
                                           std::pair{"diff_pressure@80", false},
                                           std::pair{"baro_step=5@80", false},
                                           std::pair{"mag_turned=30@80", false},
                                           std::pair{"accel_step_x=0.3@80", true},
                                           std::pair{"accel_step_y=0.3@80", true},
                                           std::pair{"accel_step_z=0.3@80", true},
                                           std::pair{"gyro_step_x=0.02@80", true},
                                           std::pair{"gyro_step_y=0.02@80", true},
                                           std::pair{"gyro_step_z=0.02@80", true}));

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
