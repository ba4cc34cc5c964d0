// SPDX-License-Identifier: BSD-3-Clause
// A motor that dies in the mission on six and eight rotors ends in a controlled landing: docs/faults.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "flight/test/flight_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr double kFault_s = 25.0;

struct Loss {
  const char* vehicle;
  std::size_t motor;
};

FlightChoice flight_with(const Loss& loss) {
  FlightChoice choice = Rig::with_faults({fmt::format("motor{}_dead@{}", loss.motor, kFault_s)});
  choice.vehicle = loss.vehicle;
  return choice;
}

class LostRotor : public ::testing::TestWithParam<Loss> {};

TEST_P(LostRotor, EndsInAControlledLanding) {
  Rig rig(flight_with(GetParam()));
  double tilt_deg = 0.0;
  while (!rig.flight->runner().finished()) {
    rig.flight->step();
    const bool down = rig.flight->truth().on_ground;
    if (rig.flight->now() > at_s(kFault_s) && !down) tilt_deg = std::max(tilt_deg, rig.tilt_deg());
  }
  const FlightScore score = rig.flight->score();
  EXPECT_TRUE(score.outcome == Outcome::kLandedElsewhere || score.outcome == Outcome::kMissionDone)
      << outcome_name(score.outcome) << ": " << score.verdict;
  ASSERT_TRUE(score.landing.touchdown());
  EXPECT_LT(score.landing.touchdown()->tilt_rad, 0.2);
  EXPECT_LT(tilt_deg, 45.0);
  RecordProperty("tilt_deg", std::to_string(tilt_deg));
  EXPECT_TRUE(rig.flight->runner().disarmed());
}

std::vector<Loss> every_rotor() {
  std::vector<Loss> all;
  for (const auto& [vehicle, rotors] : {std::pair{"hexa_plus", 6U},
                                        {"hexarotor", 6U},
                                        {"y6", 6U},
                                        {"octo_plus", 8U},
                                        {"octorotor", 8U},
                                        {"x8", 8U}}) {
    for (std::size_t motor = 0; motor < rotors; ++motor) all.push_back({vehicle, motor});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(SixAndEight, LostRotor, ::testing::ValuesIn(every_rotor()),
                         [](const auto& instance) {
                           return fmt::format("{}_{}", instance.param.vehicle,
                                              instance.param.motor);
                         });

}  // namespace
}  // namespace rosflight::flight::testing
