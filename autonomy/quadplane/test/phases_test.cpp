// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/phases.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace rosflight::autonomy::quadplane {
namespace {

using P = Conditions;
constexpr auto kArmed = static_cast<std::uint16_t>(P::kArmed);
constexpr std::uint16_t kEverything = 0x1FFF;

Phase next(Phase from, unsigned conditions) {
  return kPhaseTable.next(from, static_cast<std::uint16_t>(conditions | kArmed));
}

TEST(Phases, AFlightGoesThroughAll) {
  EXPECT_EQ(next(Phase::kDisarmed, 0), Phase::kTakeoff);
  EXPECT_EQ(next(Phase::kTakeoff, P::kUp), Phase::kTransition);
  EXPECT_EQ(next(Phase::kTransition, P::kWingborne | P::kBegun), Phase::kCruise);
  EXPECT_EQ(next(Phase::kCruise, P::kBraking | P::kBegun), Phase::kBack);
  EXPECT_EQ(next(Phase::kBack, P::kBraking | P::kArrived | P::kBegun), Phase::kHover);
  EXPECT_EQ(next(Phase::kHover, P::kArrived), Phase::kLanding);
  EXPECT_EQ(next(Phase::kLanding, P::kTouched), Phase::kLanded);
}

/// Under every set of conditions: the wing alone carries only after kWingborne, in the transition forward.
TEST(Phases, CruiseIsEnteredWingborneOnly) {
  for (std::size_t phase = 0; phase < kPhaseTable.phases(); ++phase) {
    const auto from = static_cast<Phase>(phase);
    if (from == Phase::kCruise) continue;
    for (unsigned bits = 0; bits <= kEverything; ++bits) {
      if (next(from, bits) != Phase::kCruise) continue;
      ASSERT_EQ(from, Phase::kTransition);
      ASSERT_NE(bits & P::kWingborne, 0U);
    }
  }
}

/// In flight the pilot's hand is above everything but being disarmed.
TEST(Phases, ThePilotHasEveryPhaseInFlight) {
  for (const Phase from : {Phase::kTakeoff, Phase::kTransition, Phase::kCruise, Phase::kBack,
                           Phase::kHover, Phase::kLanding}) {
    for (unsigned bits = 0; bits <= kEverything; ++bits) {
      if ((bits & P::kPilot) != 0) {
        ASSERT_EQ(next(from, bits), Phase::kPilot);
      }
      ASSERT_EQ(kPhaseTable.next(from, static_cast<std::uint16_t>(bits & ~1U)), Phase::kDisarmed);
    }
  }
}

/// From every phase the ground is reached by conditions alone, and nothing leads off it again.
TEST(Phases, EveryPhaseLeadsToTheGround) {
  std::set<Phase> leads{Phase::kLanded};
  for (std::size_t k = 0; k < kPhaseTable.phases(); ++k) {
    for (const auto& row : kPhaseTable.transitions()) {
      if (leads.contains(row.to)) leads.insert(row.from);
    }
  }
  EXPECT_EQ(leads.size(), kPhaseTable.phases());
  for (unsigned bits = 0; bits <= kEverything; ++bits)
    ASSERT_EQ(next(Phase::kLanded, bits), Phase::kLanded);
}

TEST(Phases, AskedToLandItLandsFromTakeoffAndHover) {
  EXPECT_EQ(next(Phase::kTakeoff, P::kLandAsked), Phase::kLanding);
  EXPECT_EQ(next(Phase::kTakeoff, P::kReturnAsked | P::kUp), Phase::kLanding);
  EXPECT_EQ(next(Phase::kHover, P::kLandAsked), Phase::kLanding);
}

/// Given back it goes on from where it is: near the ground down, before the path up, else along the path.
TEST(Phases, GivenBack) {
  EXPECT_EQ(next(Phase::kPilot, P::kPilot | P::kBegun), Phase::kPilot);
  EXPECT_EQ(next(Phase::kPilot, P::kBegun), Phase::kTransition);
  EXPECT_EQ(next(Phase::kPilot, P::kBegun | P::kBraking), Phase::kBack);
  EXPECT_EQ(next(Phase::kPilot, 0), Phase::kTakeoff);
  EXPECT_EQ(next(Phase::kPilot, P::kLow | P::kBegun), Phase::kLanding);
  EXPECT_EQ(next(Phase::kPilot, P::kLandAsked), Phase::kLanding);
}

TEST(Phases, AllHaveNames) {
  std::set<std::string> names;
  for (std::size_t k = 0; k < kPhaseTable.phases(); ++k) names.insert(name(static_cast<Phase>(k)));
  EXPECT_EQ(names.size(), kPhaseTable.phases());
  EXPECT_EQ(std::string(name(Phase::kPilot)), "pilot");
}

}  // namespace
}  // namespace rosflight::autonomy::quadplane
