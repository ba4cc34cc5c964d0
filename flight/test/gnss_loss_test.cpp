// SPDX-License-Identifier: BSD-3-Clause
// A fixed wing that loses the satellites in its mission, in calm air and in gusts: docs/faults.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "autonomy/common/angles.hpp"
#include "flight/test/fixedwing_rig.hpp"

namespace rosflight::flight::testing {
namespace {

constexpr double kLost_s = 80.0;

/// What the flight must keep from the loss to the touchdown, by the truth.
struct Worst {
  double bank_rad{};
  double airspeed_m_s{99.0};  ///< Before the flare.
};

Worst fly(Rig& rig) {
  Worst worst;
  while (!rig.flight->finished()) {
    rig.flight->step();
    const sim::Truth& truth = rig.flight->truth();
    if (sim::to_seconds(truth.time) < kLost_s || truth.on_ground) continue;
    const auto attitude = autonomy::RollPitch::of(truth.body.q_WB);
    worst.bank_rad = std::max(worst.bank_rad, std::abs(attitude.roll_rad));
    const std::string_view phase = rig.flight->autonomy().phase;
    if (phase == "flare" || phase == "rollout") continue;
    const sim::Vector3 v_W = truth.body.q_WB * truth.body.v_B;
    worst.airspeed_m_s = std::min(worst.airspeed_m_s, (v_W - truth.air.wind_W).norm());
  }
  return worst;
}

/// The wind: "" is calm air.
class GnssLoss : public ::testing::TestWithParam<const char*> {
 protected:
  static FlightChoice choice(std::vector<std::string> faults) {
    FlightChoice out = fixedwing("default", std::move(faults));
    if (*GetParam() != '\0') out.wind = GetParam();
    return out;
  }
  static void expect_in_control(const Worst& worst) {
    // Commanded are 45 degrees at most; gusts add up to 4 in an arc.
    EXPECT_LE(worst.bank_rad, 50.0 * autonomy::kRadPerDeg);
    EXPECT_GE(worst.airspeed_m_s, 10.5);  // as FixedWingDecisions has it for the descent
  }
};

TEST_P(GnssLoss, SatellitesThatAreBackWithinTwoMinutesLetTheMissionGoOn) {
  for (const char* fault : {"gnss@80:60", "gnss@80:115"}) {
    Rig rig(choice({fault}));
    const Worst worst = fly(rig);
    EXPECT_TRUE(rig.completed()) << fault << ": " << rig.flight->score().verdict;
    SCOPED_TRACE(fault);
    expect_in_control(worst);
  }
}

TEST_P(GnssLoss, WithoutSatellitesForGoodItComesDownSoftlyByRangeSensorOrBarometer) {
  for (const char* also : {"", "range@81", "baro@81"}) {
    std::vector<std::string> faults{"gnss@80"};
    if (*also != '\0') faults.emplace_back(also);
    Rig rig(choice(faults));
    const Worst worst = fly(rig);
    const FlightScore score = rig.flight->score();
    SCOPED_TRACE(std::string("also ") + also + ": " + score.verdict);
    EXPECT_EQ(score.outcome, Outcome::kLandedElsewhere);
    EXPECT_TRUE(rig.flight->runner().disarmed());
    ASSERT_TRUE(score.landing.touchdown());
    EXPECT_LE(score.landing.touchdown()->hardest_m_s, 2.0);
    expect_in_control(worst);
  }
}

INSTANTIATE_TEST_SUITE_P(Winds, GnssLoss, ::testing::Values("", "5,0,5", "5,270,4", "6,270,6"));

}  // namespace
}  // namespace rosflight::flight::testing
