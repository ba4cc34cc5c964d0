// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/mission.hpp"

#include <gtest/gtest.h>

#include "autonomy/fixedwing/config.hpp"
#include "autonomy/multirotor/mission.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

Mission read(std::string_view text) {
  return read_mission(text, "m.yaml", MissionLimits{}, Geodetic{40.0, -111.0, 1400.0});
}

std::string fault(std::string_view text) {
  try {
    static_cast<void>(read(text));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "read";
}

/// Points 24, 25, 26: ROSflight 2.x's own file, whole.
TEST(FixedWingMission, ReadsTheReferencesExample) {
  const Mission m = load_mission("missions/reference_fixedwing.yaml", MissionLimits{});
  ASSERT_EQ(m.waypoints.size(), 4U);
  EXPECT_EQ(m.waypoints[3].p_W, Vector3(400.0, -50.0, -70.0));
  EXPECT_EQ(m.waypoints[1].passing, Passing::kFillet);
  EXPECT_EQ(m.waypoints[1].airspeed_m_s, 17.0);
  EXPECT_EQ(m.waypoints[1].course_rad, 1.1518);
}

TEST(FixedWingMission, ShippedMissionsLoad) {
  for (const char* name :
       {"fixedwing", "hourglass_line", "hourglass_dubins", "racetrack", "climb_and_descent"}) {
    EXPECT_NO_THROW(static_cast<void>(load_mission(std::string("missions/") + name + ".yaml", {})))
        << name;
  }
}

TEST(FixedWingMission, ReadsEveryKey) {
  const Mission m = read(R"(takeoff_height_m: 35
at_end: return
path: dubins
radius_m: 80
landing: {aim: [10, 20], heading_deg: 90, height_m: 2}
mission:
  - {type: goto, w: [400, 0, -70], psi: 1.5}
  - {type: goto, w: [400, 500, -60], path: line, speed: 16}
  - {type: hold, w: [0, 500, -60], hold_seconds: 20, turn: left}
)");
  EXPECT_EQ(m.takeoff_height_m, 35.0);
  EXPECT_EQ(m.at_end, AtEnd::kReturn);
  EXPECT_EQ(m.radius_m, 80.0);
  EXPECT_EQ(m.landing.aim_W, Vector3(10.0, 20.0, -2.0));
  EXPECT_NEAR(*m.landing.course_rad, 0.5 * kPi, 1e-12);
  EXPECT_EQ(m.waypoints[0].passing, Passing::kDubins);
  EXPECT_EQ(m.waypoints[1].passing, Passing::kLine);
  EXPECT_EQ(m.waypoints[2].passing, Passing::kCircle);
  EXPECT_EQ(m.waypoints[2].turn, -1);
  EXPECT_EQ(m.waypoints[2].hold_s, 20.0);
}

/// Point 24: to the millimetre, in double precision.
TEST(FixedWingMission, GeodeticWaypointsAreConvertedOnceAndExactly) {
  const Mission m = read("mission:\n  - {type: goto, use_lla: true, w: [40.001, -111, 1470]}\n");
  const Vector3 expected = ned_of({40.001, -111.0, 1470.0}, {40.0, -111.0, 1400.0});
  EXPECT_LT((m.waypoints[0].p_W - expected).norm(), 1e-9);
}

/// Everything that cannot be flown is found before the flight and named by its line.
TEST(FixedWingMission, FaultsAreNamedByLine) {
  const std::string head = "mission:\n  - {type: goto, w: [0, 0, -70]}\n";
  struct Case {
    const char* line;
    const char* words;
  };
  const Case cases[] = {
      {"{type: goto, w: [30, 0, -70]}", "30 m to the waypoint before, allowed at least the turn"},
      {"{type: goto, w: [300, 0, -150]}", "a climb of"},
      {"{type: goto, w: [300, 0, -70], speed: 60}", "speed"},
      {"{type: goto, w: [300, 0, -70], sped: 15}", "sped"},
      {"{type: goto, w: [300, 0, -2]}", "a height of 2 m"},
      {"{type: goto, w: [9000, 0, -70]}", "a position 9000 m from the start"},
      {"{type: goto, w: [300, 0, -70], path: dubins}", "heading_deg"},
      {"{type: goto, w: [300, 0, -70], path: spline}", "path"},
      {"{type: goto, w: [300, 0, -70], turn: left}", "turn"},
      {"{type: goto, w: [300, 0, -70], speed: 15, va_d: 15}", "va_d"},
      {"{type: goto, w: [300, 0, -70], use_chi: true, path: line}", "use_chi"},
      {"{type: goto, w: [300, 0], speed: 15}", "w"},
      {"{type: goto, w: [300, 0, .nan]}", "w"},
  };
  for (const Case& c : cases) {
    const std::string said = fault(head + "  - " + c.line + "\n");
    EXPECT_EQ(said.rfind("m.yaml:3", 0), 0U) << said;
    EXPECT_NE(said.find(c.words), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  // A corner is a fault of the waypoint in it, here the second of three.
  const std::string said = fault(head +
                                 "  - {type: goto, w: [300, 0, -70]}\n"
                                 "  - {type: goto, w: [0, 10, -70]}\n");
  EXPECT_EQ(said.rfind("m.yaml:3", 0), 0U) << said;
  EXPECT_NE(said.find("a turn of 178 deg"), std::string::npos) << said;
}

/// 22 m/s in turns of 50 m need 45 degrees of bank: tan = 484/490.
TEST(FixedWingMission, TurnsTooSteepForTheirSpeedAreRefused) {
  const std::string said = fault("mission:\n  - {type: goto, w: [300, 0, -70], speed: 21}\n");
  EXPECT_NE(said.find("a bank of 42 deg, allowed a bank of at most 40 deg"), std::string::npos)
      << said;
  EXPECT_EQ(fault("radius_m: 70\nmission:\n  - {type: goto, w: [300, 0, -70], speed: 21}\n"),
            "read");
}

TEST(FixedWingMission, OneFormatForBothVehicles) {
  const char* text =
      "mission:\n  - {type: goto, w: [0, 0, -50], psi: 0, speed: 5}\n"
      "  - {type: hold, w: [100, 0, -50], heading_deg: 90, hold_seconds: 3, speed: 5}\n";
  EXPECT_EQ(
      autonomy::multirotor::read_mission(text, "m.yaml", autonomy::multirotor::MissionLimits{})
          .waypoints.size(),
      2U);
  MissionLimits slow;
  slow.min_airspeed_m_s = 4.0;
  EXPECT_EQ(read_mission(text, "m.yaml", slow).waypoints.size(), 2U);
  // What only one of them can do is named by the other.
  try {
    static_cast<void>(autonomy::multirotor::read_mission(
        "mission:\n  - {type: goto, w: [0, 0, -50], psi: 0, path: dubins}\n", "m.yaml", {}));
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("it is for a fixed wing"), std::string::npos);
  }
}

TEST(FixedWingMission, HoldAndCycleOfOnePointCircleIt) {
  for (const char* end : {"hold", "cycle"}) {
    const Mission m =
        read(std::string("at_end: ") + end + "\nmission:\n  - {type: goto, w: [300, 0, -70]}\n");
    EXPECT_EQ(m.waypoints[0].passing, Passing::kCircle);
    EXPECT_TRUE(m.waypoints[0].hold_indefinitely);
  }
}

AutonomyConfig configure(std::string_view text) {
  const auto document = config::Document::from_text(text, "v.yaml");
  return read_autonomy(document.root(), VehicleFacts{.mass_kg = 4.5});
}

TEST(FixedWingConfig, DegreesBecomeRadiansOnce) {
  const AutonomyConfig c = configure("limits: {roll_deg: 50, turn_radius_m: 80}\n");
  EXPECT_NEAR(c.flight.controller.max_roll_rad, 50.0 * kRadPerDeg, 1e-12);
  EXPECT_EQ(c.flight.plan.radius_m, 80.0);
  EXPECT_EQ(c.mission.plan.radius_m, 80.0);
}

TEST(FixedWingConfig, FaultsAreNamed) {
  for (const char* text :
       {"limits: {rol_deg: 50}\n", "limits: {turn_radius_m: 20}\n", "landing: {glide_slope: 0.4}\n",
        "energy: {longitudinal: magic}\n", "energy: {min_throttle: 0.5, max_throttle: 0.4}\n",
        "takeoff: {height_m: 5}\n", "controller: {roll: {ki: 1}}\n"}) {
    EXPECT_THROW(static_cast<void>(configure(text)), config::Error) << text;
  }
}

/// C_m0 + C_ma alpha + C_mde de = 0: the trims of ROSflight 2.x's Anaconda by hand.
TEST(FixedWingConfig, ElevatorTrimFollowsFromTheDerivatives) {
  const auto document = config::Document::from_text("elevator_travel_deg: 40\n", "v.yaml");
  const AutonomyConfig c =
      read_autonomy(document.root(), VehicleFacts{.mass_kg = 4.5,
                                                  .pitch_zero = 0.135,
                                                  .pitch_alpha_1_rad = -2.74,
                                                  .pitch_elevator_1_rad = -0.99});
  EXPECT_NEAR(c.flight.controller.airframe.elevator_trim, -0.1953, 1e-3);
  EXPECT_NEAR(c.flight.controller.airframe.elevator_1_rad, 3.964, 1e-3);
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
