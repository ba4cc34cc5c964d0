// SPDX-License-Identifier: BSD-3-Clause
// What the fault campaign flies and what it asks for; no flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bench/faults/report.hpp"
#include "sim/faults.hpp"

namespace rosflight::bench::faults {
namespace {

Case multirotor(const char* first, const char* pilot = "hover", const char* second = "") {
  return {0, pilot, first, second, "leg", false};
}
Case fixedwing(const char* first, const char* second = "") {
  return {1, "hover", first, second, "leg", false};
}

TEST(FaultCases, EveryFaultIsOneThatCanBeAskedForAndFitsItsVehicle) {
  for (const bool fixed_wing : {false, true}) {
    std::set<std::string> seen;
    for (const FaultRow& row : fault_rows(fixed_wing)) {
      EXPECT_NO_THROW(static_cast<void>(sim::parse_fault(at_time(row.text, 12.5)))) << row.text;
      EXPECT_TRUE(seen.insert(row.text).second) << row.text << " twice";
    }
    EXPECT_EQ(seen.contains("servo1_stuck"), fixed_wing);
    EXPECT_EQ(seen.contains("pitot_blocked"), fixed_wing);
  }
  EXPECT_EQ(at_time("imu:0.3", 12.5), "imu@12.5000:0.3");
  EXPECT_EQ(at_time("baro_step=-10", 3.0), "baro_step=-10@3.0000");
}

TEST(FaultCases, AreAllSinglesTheFailsafeCommandAndAllPairs) {
  const std::vector<Case> cases = all_cases();
  const auto count = [&](auto is) { return std::ranges::count_if(cases, is); };
  const auto m = static_cast<std::ptrdiff_t>(fault_rows(false).size());
  const auto w = static_cast<std::ptrdiff_t>(fault_rows(true).size());
  EXPECT_EQ(count([](const Case& c) { return c.second.empty() && !c.failsafe_command; }),
            std::ptrdiff_t{2 * 7} * (m + w));
  EXPECT_EQ(count([](const Case& c) { return c.failsafe_command; }), 2 * 7 * 3);
  const auto kinds = [](bool fixed_wing) {
    const auto rows = fault_rows(fixed_wing);
    return std::ranges::count_if(rows, [](const FaultRow& row) { return row.first_of_kind; });
  };
  const auto pairs = [](std::ptrdiff_t n) { return n * (n - 1) / 2; };
  EXPECT_EQ(count([](const Case& c) { return !c.second.empty(); }),
            std::ptrdiff_t{2 * 2} * (pairs(kinds(false)) + pairs(kinds(true))));
}

TEST(FaultRules, ACrashIsAllowedForTheReasonsOnTheListOnly) {
  EXPECT_EQ(rule_of(fixedwing("servo1_stuck")), Rule::kPitchSurface);
  EXPECT_EQ(rule_of(fixedwing("servo0_stuck")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("motor0_dead:1")), Rule::kRotorDead);
  EXPECT_EQ(rule_of(fixedwing("motor0_dead:1")), Rule::kNone) << "a fixed wing glides";
  EXPECT_EQ(rule_of(multirotor("motor0_partial=0.5")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("imu_stuck:1")), Rule::kImuGone);
  EXPECT_EQ(rule_of(multirotor("imu:0.3")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("gyro_step_z=0.5")), Rule::kGyroBeyond);
  EXPECT_EQ(rule_of(multirotor("gyro_step_z=0.1")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("link_cut:3", "idle")), Rule::kPilotHasIt);
  EXPECT_EQ(rule_of(multirotor("link_cut:3", "hover")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("companion_stall:1", "idle")), Rule::kNone);
  EXPECT_EQ(rule_of(fixedwing("link_cut:3")), Rule::kNone);
  EXPECT_EQ(rule_of(fixedwing("gnss", "servo2_stuck")), Rule::kPitchSurface)
      << "the second of a pair";
}

TEST(FaultRules, ANearlyEmptyBatteryExplainsNoHardLanding) {
  EXPECT_EQ(rule_of(multirotor("battery_low")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "hover", "link_cut:3")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "hover", "companion_stall:1")), Rule::kNone);
  EXPECT_EQ(rule_of(multirotor("battery_low", "idle", "link_cut:3")), Rule::kPilotHasIt);
}

TEST(FaultRules, WhatNeedsTheMissionIsNotExplainedByASoftLanding) {
  EXPECT_TRUE(explained(multirotor("gnss:20"), Class::kMissionDone));
  EXPECT_FALSE(explained(multirotor("gnss:20"), Class::kLandedElsewhere));
  EXPECT_FALSE(explained(multirotor("companion_stall:1", "idle"), Class::kLandedElsewhere));
  EXPECT_TRUE(explained(multirotor("gnss"), Class::kLandedElsewhere));
  EXPECT_FALSE(explained(multirotor("gnss"), Class::kTimeout));
  EXPECT_FALSE(explained(multirotor("gnss"), Class::kHardLanding));
  EXPECT_TRUE(explained(multirotor("imu_stuck:1"), Class::kCrash));
  EXPECT_FALSE(explained(multirotor("rc_silence:10"), Class::kLandedElsewhere));
  Case failsafe = multirotor("rc_silence:10");
  failsafe.failsafe_command = true;
  EXPECT_TRUE(explained(failsafe, Class::kLandedElsewhere));
  EXPECT_FALSE(explained(failsafe, Class::kCrash));
  EXPECT_TRUE(explained(multirotor("gnss:20", "hover", "mag"), Class::kLandedElsewhere))
      << "a pair";
  EXPECT_FALSE(explained(multirotor("link_cut:3", "hover"), Class::kLandedElsewhere));
  EXPECT_TRUE(explained(multirotor("link_cut:3", "idle"), Class::kCrash));
}

Flown flown(const Case& c, Class ended) {
  Flown out;
  out.flight = c;
  out.faults = {at_time(c.first, 20.0)};
  out.ended = ended;
  out.verdict = "verdict";
  return out;
}

TEST(FaultPage, SaysWhatWasFlownAndFindsWhatDiffers) {
  std::vector<Flown> list{flown(multirotor("gnss"), Class::kLandedElsewhere),
                          flown(multirotor("imu_stuck:1"), Class::kCrash)};
  const std::string page = as_page(list);
  EXPECT_NE(page.find("| `gnss` |  |  |  | landed |"), std::string::npos) << page;
  EXPECT_NE(page.find("crash R3"), std::string::npos);
  EXPECT_NE(page.find("Nothing."), std::string::npos);
  EXPECT_TRUE(differences(list, page).empty());
  list[0].ended = Class::kCrash;
  ASSERT_EQ(differences(list, page).size(), 1U);
  EXPECT_EQ(
      differences(list, page)[0],
      "docs/fault-matrix.md: multirotor, pilot's stick hover, gnss, leg: written landed, flown "
      "crash ?");
  EXPECT_NE(as_page(list).find("- `./rosflight fly --fault gnss@20.0000`: verdict"),
            std::string::npos);
  EXPECT_EQ(differences(list, "").size(), 2U);
  EXPECT_NE(as_text(list).find("crash ?"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::bench::faults
