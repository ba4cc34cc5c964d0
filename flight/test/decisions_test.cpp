// SPDX-License-Identifier: BSD-3-Clause
// What ends a mission early, flown by both vehicles in wind with gusts: docs/faults.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

struct Vehicle {
  const char* name;
  double end_s;  ///< In the middle of the mission.
  autonomy::Fence fence;
  double low_m;  ///< Height of a fence that the mission crosses upwards.
  /// Share of the charge at the start with which return_cell_V is reached in the mission.
  double charge;
  double home_m;     ///< It lands within this of the start.
  double at_once_s;  ///< A landing where it is, or at the landing point, takes no longer.
  bool waits;        ///< After a return it circles until somebody asks for the landing.
};

class InWind : public ::testing::TestWithParam<Vehicle> {
 protected:
  static FlightChoice choice() {
    FlightChoice out;
    out.vehicle = GetParam().name;
    out.wind = "6,270,6";
    return out;
  }
  /// A battery that is nearly empty at the start, whose charge alone would decide nothing.
  static FlightChoice with_low_battery(std::vector<std::string> levels) {
    FlightChoice out = choice();
    out.overrides = std::move(levels);
    out.overrides.push_back("battery.initial_charge=" + std::to_string(GetParam().charge));
    for (const char* level : {"warn", "return", "land"}) {
      out.overrides.push_back("autonomy.battery." + std::string(level) + "_charge=0");
    }
    return out;
  }
  /// Steps until a note contains a text. @returns false: the flight has ended without it.
  static bool reach_note(Rig& rig, const std::string& text) {
    bool noted = false;
    rig.flight->runner().set_notify([&](const FlightNote& note) {
      noted = noted || note.text.find(text) != std::string::npos;
    });
    while (!noted && !rig.flight->finished()) rig.flight->step();
    rig.flight->runner().set_notify(nullptr);
    return noted;
  }
  /// Soft, and not at the end of the mission.
  static void expect_down(const Rig& rig) {
    const FlightScore score = rig.flight->score();
    EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere) << score.verdict;
    EXPECT_TRUE(rig.flight->runner().disarmed());
    EXPECT_TRUE(score.landing.soft(score.limits)) << score.verdict;
    EXPECT_LT(score.waypoints_reached(), score.waypoints.size());
  }
  /// The same, at the start.
  static void expect_home(const Rig& rig) {
    expect_down(rig);
    const FlightScore score = rig.flight->score();
    EXPECT_LT(score.landing.distance_m(score.limits), GetParam().home_m) << score.verdict;
  }
};

TEST_P(InWind, ALowBatteryBringsItBack) {
  FlightChoice wanted = choice();
  wanted.faults = {"battery_low@" + std::to_string(GetParam().end_s)};
  Rig rig(wanted);
  rig.flight->run();
  expect_home(rig);
}

TEST_P(InWind, ALowVoltageBringsItBack) {
  Rig rig(with_low_battery({}));
  ASSERT_TRUE(reach_note(rig, "battery low: returns"));
  EXPECT_GT(rig.height_m(), 2.0);
  rig.flight->run();
  expect_home(rig);
}

TEST_P(InWind, AnEmptyBatteryLandsItAtOnce) {
  Rig rig(with_low_battery({"autonomy.battery.land_cell_V=3.72", "autonomy.battery.return_cell_V=0",
                            "autonomy.battery.warn_cell_V=0"}));
  ASSERT_TRUE(reach_note(rig, "battery low: lands"));
  EXPECT_GT(rig.height_m(), 2.0);
  const double decided_s = sim::to_seconds(rig.flight->now());
  const sim::Vector3 decided_W = rig.flight->truth().body.p_W;
  rig.flight->run();
  expect_down(rig);
  EXPECT_LT(sim::to_seconds(rig.flight->now()) - decided_s, GetParam().at_once_s);
  const auto landing = rig.flight->score().landing;
  ASSERT_TRUE(landing.touchdown());
  const sim::Vector3 there_W = rig.setup->fixed_wing() ? sim::Vector3::Zero().eval() : decided_W;
  EXPECT_LT((landing.touchdown()->p_W - there_W).head<2>().norm(), GetParam().home_m);
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

TEST_P(InWind, AboveTheFenceItComesDownAndBack) {
  const double top_m = GetParam().low_m;
  Rig rig(choice());
  std::visit([&](auto& plan) { plan.mission.fence = autonomy::Fence{1000.0, top_m}; },
             rig.setup->plan);
  rig.flight = std::make_unique<Flight>(*rig.setup);
  ASSERT_TRUE(reach_note(rig, "outside of the fence: returns"));
  EXPECT_GT(rig.height_m(), top_m - 1.0);
  rig.run_for(15.0);
  double highest_m = 0.0;
  while (!rig.flight->finished()) {
    rig.flight->step();
    highest_m = std::max(highest_m, rig.height_m());
  }
  EXPECT_LT(highest_m, top_m) << "the return leads inside";
  expect_home(rig);
}

INSTANTIATE_TEST_SUITE_P(
    Vehicles, InWind,
    ::testing::Values(Vehicle{"multirotor", 20.0, {8.0, 30.0}, 4.5, 0.185, 3.0, 20.0, false},
                      Vehicle{"anaconda", 80.0, {300.0, 120.0}, 60.0, 0.19, 50.0, 180.0, true}),
    [](const auto& vehicle) { return std::string(vehicle.param.name); });

}  // namespace
}  // namespace rosflight::flight::testing
