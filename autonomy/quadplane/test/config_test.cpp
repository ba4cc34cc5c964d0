// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/config.hpp"

#include <gtest/gtest.h>

#include "autonomy/quadplane/test/plant.hpp"

namespace rosflight::autonomy::quadplane {
namespace {

std::string refusal(const std::string& text, const VehicleFacts& vehicle) {
  try {
    static_cast<void>(read_autonomy(config::Document::from_text(text, "v.yaml").root(), vehicle));
  } catch (const config::Error& error) {
    return error.what();
  }
  return {};
}

/// sqrt(2 * 6 * 9.80665/(1.1 * 0.5 * 1.25)) = sqrt(171.17) by hand.
TEST(Config, StallSpeedIsTheLiftEquation) {
  EXPECT_NEAR(testing::facts().stall_speed_m_s(), 13.083, 1e-3);
}

TEST(Config, StallSpeedGrowsWithTheRootOfTheMass) {
  VehicleFacts heavy = testing::facts();
  heavy.mass_kg *= 4.0;
  EXPECT_NEAR(heavy.stall_speed_m_s(), 2.0 * testing::facts().stall_speed_m_s(), 1e-9);
}

/// 1.2 * 13.083 = 15.70
TEST(Config, ACruiseBelowTheMarginToTheStallIsRefused) {
  const std::string text = refusal("limits: {cruise_m_s: 15}", testing::facts());
  EXPECT_NE(text.find("cruise_m_s"), std::string::npos) << text;
  EXPECT_NE(text.find("15.69"), std::string::npos) << text;
  EXPECT_EQ(refusal("limits: {cruise_m_s: 15.8}", testing::facts()), "");
}

TEST(Config, RotorsThatHardlyLiftTheWeightAreRefused) {
  VehicleFacts weak = testing::facts();
  weak.max_lift_force_N = 70.0;
  EXPECT_NE(refusal("{}", weak).find("1.3 weights"), std::string::npos);
}

TEST(Config, CellsAndCapacityComeFromTheVehicle) {
  const AutonomyConfig c =
      read_autonomy(config::Document::from_text("{}", "v.yaml").root(), testing::facts());
  EXPECT_EQ(c.flight.battery.cells, 6.0);
  EXPECT_EQ(c.flight.battery.capacity_Ah, 8.0);
}

}  // namespace
}  // namespace rosflight::autonomy::quadplane
