// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/mission.hpp"

#include <gtest/gtest.h>

namespace rosflight::autonomy::quadplane {
namespace {

std::string fault(const std::string& waypoints) {
  try {
    static_cast<void>(read_mission("mission:\n" + waypoints, "m.yaml", MissionLimits{}));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "read";
}

TEST(Mission, ReadsTheShippedOne) {
  const Mission m = load_mission("missions/quadplane.yaml", MissionLimits{});
  ASSERT_EQ(m.waypoints_W.size(), 5U);
  EXPECT_EQ(m.waypoints_W.back(), Vector3(250.0, 0.0, -30.0));
  EXPECT_EQ(m.takeoff_height_m, 30.0);
}

TEST(Mission, RefusesALegShorterThanItsCorners) {
  const std::string text =
      fault("  - {type: goto, w: [300, 0, -30]}\n  - {type: goto, w: [300, 90, -30]}\n");
  EXPECT_NE(text.find("longer than its corners of 100 m"), std::string::npos) << text;
}

/// 1.5 * 60/300 = 0.3
TEST(Mission, RefusesALegThatIsTooSteep) {
  const std::string text = fault("  - {type: goto, w: [300, 0, -90]}\n");
  EXPECT_NE(text.find("0.3 as the steepest slope"), std::string::npos) << text;
  EXPECT_EQ(fault("  - {type: goto, w: [300, 0, -70]}\n"), "read");
}

TEST(Mission, RefusesToHoldInBetween) {
  EXPECT_NE(fault("  - {type: hold, w: [300, 0, -30]}\n").find("goto"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::autonomy::quadplane
