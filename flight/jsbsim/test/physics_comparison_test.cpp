// SPDX-License-Identifier: BSD-3-Clause
#include "flight/jsbsim/physics_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "flight/fly.hpp"
#include "flight/gazebo/gazebo_engine.hpp"
#include "flight/repeat.hpp"

namespace rosflight::flight {
namespace {

constexpr double kDegree_rad = 3.14159265358979323846 / 180.0;

struct Case {
  const char* name;
  const char* physics;
  const char* vehicle;
  const char* mission;
  const char* wind;  ///< Empty: none.
};

class Flights : public testing::TestWithParam<Case> {};

TEST_P(Flights, AgreeWithOurIntegrator) {
  const Case& c = GetParam();
  if (std::string(c.physics) == "gazebo" &&
      !std::filesystem::exists(GazeboEngine::Options::program_of_project()))
    GTEST_SKIP() << "gazebo_engine is not built";
  FlightChoice choice;
  choice.vehicle = c.vehicle;
  choice.mission = c.mission;
  if (*c.wind != '\0') choice.wind = c.wind;
  const PhysicsComparison flown = compare_physics(choice, c.physics);
  EXPECT_TRUE(flown.success[0]);
  EXPECT_TRUE(flown.success[1]);
  const double allowed_m = choice.vehicle == "anaconda" ? 0.3 : 0.05;
  EXPECT_LT(flown.position_m.rms(), allowed_m);
  EXPECT_GT(flown.position_m.rms(), 1e-9);  // it was another engine
  EXPECT_NEAR(flown.tracking_rms_m[0], flown.tracking_rms_m[1], allowed_m);
  EXPECT_LT(flown.attitude_rad.rms(), 1.0 * kDegree_rad);
  if (!choice
           .wind) {  // in gusts a leg may begin a step of guidance later, and the turn into it with it
    EXPECT_LT(flown.attitude_rad.largest(), 1.0 * kDegree_rad);
  }
  EXPECT_NEAR(flown.touchdown_speed_m_s[0], flown.touchdown_speed_m_s[1], 0.1);
}

INSTANTIATE_TEST_SUITE_P(
    All, Flights,
    testing::Values(Case{"multirotor", "jsbsim", "multirotor", "default", ""},
                    Case{"fixedwing", "jsbsim", "anaconda", "default", ""},
                    Case{"hover", "jsbsim", "multirotor", "hover", ""},
                    Case{"multirotor_wind", "jsbsim", "multirotor", "hop", "6,270,4"},
                    Case{"fixedwing_wind", "jsbsim", "anaconda", "default", "6,270,4"},
                    Case{"gazebo_multirotor", "gazebo", "multirotor", "default", ""},
                    Case{"gazebo_fixedwing", "gazebo", "anaconda", "default", ""},
                    Case{"gazebo_hover", "gazebo", "multirotor", "hover", ""},
                    Case{"gazebo_multirotor_wind", "gazebo", "multirotor", "hop", "6,270,4"},
                    Case{"gazebo_fixedwing_wind", "gazebo", "anaconda", "default", "6,270,4"},
                    Case{"coupling_multirotor", "runge_kutta_held", "multirotor", "default", ""},
                    Case{"coupling_fixedwing", "runge_kutta_held", "anaconda", "default", ""}),
    [](const auto& flights) { return std::string(flights.param.name); });

/// Dartsim is of first order in the position: what is not of the closed loop goes with the step.
TEST(Physics, HalfTheStepBringsGazeboNearer) {
  if (!std::filesystem::exists(GazeboEngine::Options::program_of_project()))
    GTEST_SKIP() << "gazebo_engine is not built";
  const auto largest_m = [](const char* step) {
    FlightChoice choice;
    choice.vehicle = "tricopter";
    choice.mission = "default";
    choice.overrides.emplace_back(std::string("body.max_step_s=") + step);
    return compare_physics(choice, "gazebo").position_m.largest();
  };
  const double whole_m = largest_m("0.0025");
  EXPECT_GT(whole_m, 0.01) << "more than noise and rounding make of a flight";
  EXPECT_LT(largest_m("0.00125"), 0.5 * whole_m);
}

TEST(Physics, AnUnknownNameIsRejected) {
  FlightChoice choice;
  choice.physics = "bullet";
  const FlightSetup setup(choice);
  try {
    const Flight flight(setup);
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "--physics: found bullet, allowed runge_kutta, runge_kutta_held, jsbsim, gazebo");
  }
}

TEST(Physics, ALogSaysWhatMovedTheBody) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "rosflight_physics";
  std::filesystem::remove_all(folder);
  FlyOptions options;
  options.folder = folder;
  options.choice.mission = "hop";
  options.choice.physics = "runge_kutta_held";
  EXPECT_TRUE(fly(options).score.success());
  EXPECT_EQ(read_recorded_flight(folder).choice.physics, "runge_kutta_held");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rosflight::flight
