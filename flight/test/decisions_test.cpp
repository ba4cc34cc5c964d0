// SPDX-License-Identifier: BSD-3-Clause
// What ends a mission early, flown by both vehicles in wind with gusts: docs/faults.md.
#include <gtest/gtest.h>

#include <variant>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

struct Vehicle {
  const char* name;
  double end_s;  ///< In the middle of the mission.
  autonomy::Fence fence;
  double home_m;  ///< It lands within this of the start.
  bool waits;     ///< After a return it circles until somebody asks for the landing.
};

class InWind : public ::testing::TestWithParam<Vehicle> {
 protected:
  static FlightChoice choice() {
    FlightChoice out;
    out.vehicle = GetParam().name;
    out.wind = "6,270,6";
    return out;
  }
  /// Soft, at the start, and not at the end of the mission.
  static void expect_home(const Rig& rig) {
    const FlightScore score = rig.flight->score();
    EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << score.verdict;
    EXPECT_TRUE(rig.flight->runner().disarmed());
    EXPECT_TRUE(score.landing.soft(score.limits)) << score.verdict;
    EXPECT_LT(score.landing.distance_m(score.limits), GetParam().home_m) << score.verdict;
    EXPECT_LT(score.waypoints_reached(), score.waypoints.size());
  }
};

TEST_P(InWind, ALowBatteryBringsItBack) {
  FlightChoice wanted = choice();
  wanted.faults = {"battery_low@" + std::to_string(GetParam().end_s)};
  Rig rig(wanted);
  rig.flight->run();
  expect_home(rig);
}

TEST_P(InWind, AReturnThatIsAskedForBringsItBack) {
  Rig rig(choice());
  rig.run_until(GetParam().end_s);
  rig.flight->guidance().request_return();
  if (GetParam().waits) {
    rig.run_for(60.0);
    EXPECT_FALSE(rig.flight->truth().on_ground);
    rig.flight->guidance().request_land();
  }
  rig.flight->run();
  expect_home(rig);
}

TEST_P(InWind, OutsideOfTheFenceItComesBack) {
  Rig rig(choice());
  // Around less than the waypoints, which a mission file is not allowed to have.
  std::visit([](auto& plan) { plan.mission.fence = GetParam().fence; }, rig.setup->plan);
  rig.flight = std::make_unique<Flight>(*rig.setup);
  rig.flight->run();
  expect_home(rig);
}

INSTANTIATE_TEST_SUITE_P(Vehicles, InWind,
                         ::testing::Values(Vehicle{"multirotor", 20.0, {8.0, 30.0}, 3.0, false},
                                           Vehicle{"anaconda", 80.0, {300.0, 120.0}, 50.0, true}),
                         [](const auto& vehicle) { return std::string(vehicle.param.name); });

}  // namespace
}  // namespace rosflight::flight::testing
