// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/mission.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "config/strict_yaml.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

const MissionLimits kLimits{};
const Geodetic kProvo{40.2672, -111.6357, 1387.0};

Mission parse(const std::string& text, const std::optional<Geodetic>& origin = {}) {
  return read_mission(text, "m.yaml", kLimits, origin);
}

/// The message with which a text is refused; empty if it is not.
std::string refusal(const std::string& text, const std::optional<Geodetic>& origin = {}) {
  try {
    parse(text, origin);
  } catch (const config::Error& error) {
    return error.what();
  }
  return {};
}

std::string one(const std::string& waypoint) {
  return "mission:\n  - " + waypoint + "\n";
}

void expect_refused(const std::string& text, const std::vector<std::string>& says,
                    const std::optional<Geodetic>& origin = {}) {
  const std::string message = refusal(text, origin);
  EXPECT_FALSE(message.empty()) << text;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_EQ(message.rfind("m.yaml", 0), 0U) << message;
  for (const std::string& part : says) EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Mission, ReadsAllKeys) {
  const Mission m = parse(
      "takeoff_height_m: 3.5\n"
      "at_end: hold\n"
      "mission:\n"
      "  - {type: goto, w: [10, -2, -4.5], speed: 4, psi: 1.57}\n"
      "  - {type: hold, w: [1, 2, -3], heading_deg: -90, hold_seconds: 3, hold_indefinitely: "
      "false}\n"
      "  - {type: 0, w: [1, 2, -3], psi: 0, hold_indefinitely: true, use_lla: false}\n");
  EXPECT_EQ(m.takeoff_height_m, 3.5);
  EXPECT_EQ(m.at_end, AtEnd::kHold);
  ASSERT_EQ(m.waypoints.size(), 3U);
  EXPECT_EQ(m.waypoints[0].type, WaypointType::kGoto);
  EXPECT_EQ(m.waypoints[0].p_W, Vector3(10, -2, -4.5));
  EXPECT_EQ(m.waypoints[0].speed_m_s, 4.0);
  EXPECT_EQ(m.waypoints[0].psi_rad, 1.57);
  EXPECT_EQ(m.waypoints[1].type, WaypointType::kHold);
  EXPECT_NEAR(m.waypoints[1].psi_rad, -kPi / 2.0, 1e-12);
  EXPECT_EQ(m.waypoints[1].speed_m_s, kLimits.max_speed_m_s);
  EXPECT_EQ(m.waypoints[1].hold_s, 3.0);
  EXPECT_TRUE(m.waypoints[2].hold_indefinitely);
}

// Weak point 26: the file is a map with a repeated key, which aborted a debug build.
TEST(Mission, ReadsTheReferencesExample) {
  const Mission m = load_mission("missions/reference_example.yaml", kLimits);
  const Vector3 expected[] = {
      {0, 0, -10}, {20, 0, -10}, {20, -20, -20}, {0, -20, -20}, {0, 0, -40}};
  const bool holds[] = {false, false, true, false, true};
  ASSERT_EQ(m.waypoints.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(m.waypoints[k].p_W, expected[k]);
    EXPECT_EQ(m.waypoints[k].type == WaypointType::kHold, holds[k]);
    EXPECT_EQ(m.waypoints[k].speed_m_s, 4.0);
    EXPECT_EQ(m.waypoints[k].psi_rad, k == 2 ? 1.5 : 2.16);
  }
  EXPECT_EQ(m.waypoints[2].hold_s, 5.0);
  EXPECT_EQ(m.waypoints[4].hold_s, 10.0);
}

TEST(Mission, ReadsTheRepeatedKeyInAnyIndentationAndNamesItsLines) {
  EXPECT_EQ(parse("# head\n\nwp:\n    type: 1\n    w: [1, 2, -3]\n    psi: 0\nwp: {type: 1, w: [1, "
                  "2, -3], psi: 0}\n")
                .waypoints.size(),
            2U);
  EXPECT_EQ(parse("wp:\r\n  type: 1\r\n  w:\r\n  - 1\r\n  - 2\r\n  - -3\r\n  psi: 0\r\n")
                .waypoints.size(),
            1U);
  expect_refused(
      "wp:\n  type: 1\n  w: [1, 2, -3]\n  psi: 0\nwp:\n  type: 7\n  w: [1, 2, -3]\n  psi: 0\n",
      {"m.yaml:6:", "type", "7"});
}

// Weak point 26: the tutorial's goto entries without hold keys failed to load.
TEST(Mission, GotoNeedsNoHoldKeys) {
  EXPECT_EQ(parse(one("{type: goto, w: [1, 2, -3], psi: 0}")).waypoints.size(), 1U);
}

// Weak point 26: a bad entry left the entries before it loaded. A mission is a value: all or
// nothing.
TEST(Mission, OneBadEntryRefusesTheWholeFile) {
  expect_refused(
      "mission:\n  - {type: goto, w: [1, 2, -3], psi: 0}\n  - {type: goto, w: [1, 2], psi: 0}\n",
      {"m.yaml:3:", "mission.1.w", "3 numbers"});
}

// Weak point 28: a waypoint was a hold unless stated otherwise, and kept use_lla after its
// conversion.
TEST(Mission, WaypointsAreGotoAndLocal) {
  EXPECT_EQ(Waypoint{}.type, WaypointType::kGoto);
  const Mission m =
      parse(one("{type: goto, w: [40.2682, -111.6347, 1397.0], use_lla: true, psi: 0}"), kProvo);
  // PROJ 9.5.1, topocentric: 111.064644 85.077434 -9.998464
  EXPECT_NEAR(m.waypoints[0].p_W.x(), 111.064644, 1e-6);
  EXPECT_NEAR(m.waypoints[0].p_W.y(), 85.077434, 1e-6);
  EXPECT_NEAR(m.waypoints[0].p_W.z(), -9.998464, 1e-6);
}

// Weak point 25: geodetic missions loaded before the origin was known were wrong.
TEST(Mission, GeodeticWaypointsNeedAnOrigin) {
  expect_refused(one("{type: goto, w: [40.2682, -111.6347, 1397.0], use_lla: true, psi: 0}"),
                 {"m.yaml:2:", "use_lla", "true", "no known position"});
}

TEST(Mission, RefusesWithOneLine) {
  const std::string rest = ", psi: 0}";
  expect_refused("", {"empty"});
  expect_refused("mission: []\n", {"mission", "0 waypoints", "1 to 1000"});
  expect_refused("takeoff_height_m: 2\n", {"mission", "nothing"});
  expect_refused("just words\n", {"allowed"});
  expect_refused(std::string("\x00\x01\xff\xfe binary \x7f", 13), {"allowed"});
  expect_refused("mission: [\n", {"m.yaml"});
  expect_refused("mision:\n  - {}\n", {"mission"});
  expect_refused("speed: 3\n" + one("{type: goto, w: [1, 2, -3]" + rest),
                 {"m.yaml:1:", "speed", "unknown key"});
  expect_refused(one("{type: goto, w: [1, 2, -3], sped: 3" + rest),
                 {"sped", "unknown key", "speed"});
  expect_refused(one("{type: fly, w: [1, 2, -3]" + rest), {"type", "fly", "goto, hold"});
  expect_refused(one("{w: [1, 2, -3]" + rest), {"type", "nothing"});
  expect_refused(one("{type: goto" + rest), {"w", "nothing"});
  expect_refused(one("{type: goto, w: [1, x, -3]" + rest), {"w", "x"});
  expect_refused(one("{type: goto, w: [1, .nan, -3]" + rest), {"w", ".nan"});
  expect_refused(one("{type: goto, w: [1, .inf, -3]" + rest), {"w", ".inf"});
  expect_refused(one("{type: goto, w: 5" + rest), {"w", "3 numbers"});
  expect_refused(one("{type: goto, w: [3000, 0, -3]" + rest),
                 {"w", "3000 m from the start", "2000"});
  expect_refused(one("{type: goto, w: [0, 0, -130]" + rest), {"w", "130 m", "120"});
  expect_refused(one("{type: goto, w: [0, 0, 3]" + rest), {"w", "-3 m", "0.5"});
  expect_refused(one("{type: goto, w: [1, 2, -3], speed: 9" + rest), {"speed", "9", "0.1 to 5"});
  expect_refused(one("{type: goto, w: [1, 2, -3], speed: 0" + rest), {"speed", "0.1 to 5"});
  expect_refused(one("{type: goto, w: [1, 2, -3]}"), {"psi", "nothing"});
  expect_refused(one("{type: goto, w: [1, 2, -3], psi: 90}"), {"psi", "90"});
  expect_refused(one("{type: goto, w: [1, 2, -3], psi: 0, heading_deg: 0}"),
                 {"heading_deg", "either"});
  expect_refused(one("{type: goto, w: [1, 2, -3], hold_seconds: 5" + rest), {"hold_seconds", "5"});
  expect_refused(one("{type: goto, w: [1, 2, -3], hold_indefinitely: true" + rest),
                 {"hold_indefinitely"});
  expect_refused(one("{type: hold, w: [1, 2, -3]" + rest), {"hold_seconds", "nothing"});
  expect_refused(one("{type: hold, w: [1, 2, -3], hold_seconds: -1" + rest),
                 {"hold_seconds", "-1"});
  expect_refused(one("{type: hold, w: [1, 2, -3], hold_indefinitely: true, psi: 0}\n  - {type: "
                     "goto, w: [1, 2, -3]" +
                     rest),
                 {"m.yaml:3:", "for ever"});
  expect_refused(one("{type: goto, w: [1, 2, -3], w: [1, 2, -3]" + rest), {"w", "once"});
  expect_refused("at_end: crash\n" + one("{type: goto, w: [1, 2, -3]" + rest),
                 {"at_end", "crash", "land"});
  expect_refused("takeoff_height_m: 0\n" + one("{type: goto, w: [1, 2, -3]" + rest),
                 {"takeoff_height_m", "0.3"});
  expect_refused("mission:\n  goto: 1\n", {"mission", "list of maps"});
  expect_refused("mission:\n  - 3\n", {"a map"});
  expect_refused(one("{type: goto, w: [95, 0, 1400], use_lla: true" + rest), {"latitude 95"},
                 kProvo);
  expect_refused(one("{type: goto, w: [40, 190, 1400], use_lla: true" + rest), {"longitude 190"},
                 kProvo);
  expect_refused(one("{type: goto, w: [41, -111, 1400], use_lla: true" + rest),
                 {"m from the start"}, kProvo);
}

TEST(Mission, RefusesNoneAndTooManyWaypointsInEveryForm) {
  std::string text = "mission:\n";
  std::string list;
  std::string repeated;
  for (int k = 0; k < 1001; ++k) {
    text += "  - {type: goto, w: [1, 2, -3], psi: 0}\n";
    list += "- {type: goto, w: [1, 2, -3], psi: 0}\n";
    repeated += "wp: {type: 1, w: [1, 2, -3], psi: 0}\n";
  }
  expect_refused(text, {"1001 waypoints"});
  expect_refused(list, {"m.yaml: found 1001 waypoints, allowed 1 to 1000"});
  expect_refused(repeated, {"1001 waypoints"});
  expect_refused("mission: []\n", {"m.yaml:1: mission: found 0 waypoints"});
  expect_refused("[]\n", {"m.yaml: found 0 waypoints"});
}

TEST(Mission, RefusesFilesThatAreNone) {
  EXPECT_THROW(load_mission("missions/no_such.yaml", kLimits), config::Error);
  EXPECT_THROW(load_mission("missions", kLimits), config::Error);
}

TEST(Mission, ShippedMissionsLoadAndAreWorthFlying) {
  const Mission fly = load_mission("missions/default.yaml", kLimits);
  EXPECT_GE(fly.waypoints.size(), 5U);
  EXPECT_EQ(fly.at_end, AtEnd::kLand);
  bool holds = false;
  for (const Waypoint& w : fly.waypoints) {
    EXPECT_LE(w.p_W.norm(), 15.0);
    holds = holds || w.type == WaypointType::kHold;
  }
  EXPECT_TRUE(holds);
  EXPECT_EQ(load_mission("missions/square.yaml", kLimits).waypoints.size(), 4U);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
