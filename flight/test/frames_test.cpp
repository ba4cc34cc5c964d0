// SPDX-License-Identifier: BSD-3-Clause
// Every vehicle of a predefined or custom mixer flies the default mission of its kind: vehicles/README.md.
#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

/// A flight of the default mission, which has to be a success.
Rig flown(const char* vehicle) {
  FlightChoice choice;
  choice.vehicle = vehicle;
  Rig rig(choice);
  rig.flight->run();
  const FlightScore score = rig.flight->score();
  EXPECT_EQ(score.outcome, Outcome::kMissionDone) << score.verdict;
  return rig;
}

class Multirotors : public ::testing::TestWithParam<const char*> {};

TEST_P(Multirotors, FlyTheDefaultMission) {
  const Rig rig = flown(GetParam());
  EXPECT_LT(rig.flight->own_tracking().rms(), 0.15);
}

INSTANTIATE_TEST_SUITE_P(Frames, Multirotors,
                         ::testing::Values("quad_plus", "hexa_plus", "hexarotor", "octo_plus",
                                           "octorotor", "y6", "x8", "tricopter"),
                         [](const auto& instance) { return std::string(instance.param); });

class FixedWings : public ::testing::TestWithParam<const char*> {};

TEST_P(FixedWings, FlyTheDefaultMission) {
  const Rig rig = flown(GetParam());
  expect_tracked(rig);
  EXPECT_LE(record(rig).roll.max, 60.0 * autonomy::kRadPerDeg);
  expect_touchdown(rig, 15.0, 1.5);
}

INSTANTIATE_TEST_SUITE_P(Frames, FixedWings, ::testing::Values("fixedwing", "flying_wing"),
                         [](const auto& instance) { return std::string(instance.param); });

}  // namespace
}  // namespace rosflight::flight::testing
