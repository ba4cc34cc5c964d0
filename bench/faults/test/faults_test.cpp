// SPDX-License-Identifier: BSD-3-Clause
// What the fault campaign flies and what it asks for; no flight.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

#include "bench/faults/report.hpp"
#include "flight/project_root.hpp"
#include "sim/faults.hpp"

namespace rosflight::bench::faults {
namespace {

Case multirotor(const char* first, const char* pilot = "hover", const char* second = "") {
  return {0, pilot, first, second, "leg", false};
}
Case fixedwing(const char* first, const char* second = "") {
  return {1, "hover", first, second, "leg", false};
}

std::string label(const Case& c) {
  return fmt::format("{} {} {} {} {} {}", c.subject, c.pilot, c.first, c.second, c.phase,
                     c.failsafe_command);
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
  const auto pairs = [](std::ptrdiff_t n) { return n * (n - 1); };  // in both orders
  EXPECT_EQ(count([](const Case& c) { return !c.second.empty(); }),
            std::ptrdiff_t{2 * 2} * (pairs(kinds(false)) + pairs(kinds(true))));
}

TEST(FaultCases, EveryPairIsFlownInBothOrdersInEveryPhaseWithBothPilots) {
  std::set<std::string> all;
  for (const Case& c : all_cases()) EXPECT_TRUE(all.insert(label(c)).second) << label(c) << " twice";
  for (Case c : all_cases()) {
    if (c.second.empty()) continue;
    std::swap(c.first, c.second);
    EXPECT_TRUE(all.contains(label(c))) << label(c);
  }
}

using Pair = std::set<std::string>;

/// The pairs of a quarter's block, in either order.
std::set<Pair> pairs_of_block(std::size_t subject, const char* pilot, const std::string& phase) {
  std::set<Pair> out;
  for (const Case& c : quarter()) {
    const bool mine = c.subject == subject && c.pilot == pilot && c.phase == phase;
    if (mine && !c.second.empty()) out.insert({c.first, c.second});
  }
  return out;
}

TEST(FaultQuarter, IsAQuarterOfTheFlightsThatDiffer) {
  std::set<std::string> all;
  std::size_t singles = 0;
  std::size_t failsafe = 0;
  std::set<std::string> pairs;
  for (const Case& c : all_cases()) {
    all.insert(label(c));
    if (c.pilot == "idle" && !stick_counts(c)) continue;
    if (c.failsafe_command) {
      ++failsafe;
    } else if (c.second.empty()) {
      ++singles;
    } else {
      Case sorted = c;
      std::tie(sorted.first, sorted.second) = std::minmax(c.first, c.second);
      pairs.insert(label(sorted));
    }
  }
  std::set<std::string> seen;
  std::array<std::size_t, 3> flown{};
  for (const Case& c : quarter()) {
    EXPECT_TRUE(all.contains(label(c))) << label(c);
    EXPECT_TRUE(seen.insert(label(c)).second) << label(c) << " twice";
    ++flown[c.failsafe_command ? 1 : c.second.empty() ? 0 : 2];
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  EXPECT_NEAR(share(flown[0], singles), 0.25, 0.01);
  EXPECT_NEAR(share(flown[1], failsafe), 0.25, 0.02);
  EXPECT_NEAR(share(flown[2], pairs.size()), 0.25, 0.01) << "either order of a pair counts once";
}

TEST(FaultQuarter, TheBlocksOfAVehicleFlyDifferentPairs) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    std::set<Pair> all;
    for (const Case& c : all_cases()) {
      if (c.subject == s && !c.second.empty()) all.insert({c.first, c.second});
    }
    std::set<Pair> covered;
    std::size_t flown = 0;
    std::size_t reversed = 0;
    const auto rows = fault_rows(subjects()[s].fixed_wing);
    const auto place = [&rows](const std::string& fault) {
      return std::ranges::find(rows, fault, &FaultRow::text) - rows.begin();
    };
    for (const Case& c : quarter()) {
      if (c.subject == s && !c.second.empty() && place(c.first) > place(c.second)) ++reversed;
    }
    for (const char* pilot : {"hover", "idle"}) {
      for (const char* phase : subjects()[s].pair_phases) {
        const auto block = pairs_of_block(s, pilot, phase);
        EXPECT_GT(block.size(), 0U) << pilot << ' ' << phase;
        flown += block.size();
        covered.insert(block.begin(), block.end());
      }
    }
    EXPECT_EQ(covered.size(), flown) << "no pair in two blocks";
    EXPECT_NEAR(static_cast<double>(reversed), 0.5 * static_cast<double>(flown), 20.0)
        << "both orders";
    if (subjects()[s].fixed_wing) {
      EXPECT_GT(covered.size(), all.size() * 3 / 4);
    } else {
      EXPECT_EQ(covered, all) << "each pair in one of the blocks";
    }
  }
}

TEST(FaultQuarter, ThePilotsFlyDifferentCellsAndEveryFaultAndPhaseIsFlown) {
  std::map<std::string, std::set<std::string>> pilots_of_cell;
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    std::set<std::string> faults;
    std::set<std::string> phases;
    for (const Case& c : quarter()) {
      if (c.subject != s || !c.second.empty() || c.failsafe_command) continue;
      faults.insert(c.first);
      phases.insert(c.phase);
      pilots_of_cell[fmt::format("{} {} {}", s, c.first, c.phase)].insert(c.pilot);
    }
    EXPECT_EQ(faults.size(), fault_rows(subjects()[s].fixed_wing).size());
    EXPECT_EQ(phases.size(), subjects()[s].phases.size());
  }
  for (const auto& [cell, pilots] : pilots_of_cell) EXPECT_EQ(pilots.size(), 1U) << cell;
}

/// The rows of a sheet of docs/fault-matrix.md by fault.
std::map<std::string, std::string> rows_of(const std::string& page, const std::string& sheet) {
  std::map<std::string, std::string> out;
  std::istringstream lines(page.substr(page.find("\n## " + sheet + "\n") + 1));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.starts_with("## ")) {
    if (!line.starts_with("| `")) continue;
    const auto end = line.find('`', 3);
    out[line.substr(3, end - 3)] = line.substr(end);
  }
  return out;
}

TEST(FaultQuarter, WhereTheStickDoesNotCountThePageHasTheSameCellsForBothPilots) {
  std::ifstream stream(flight::project_root() / "docs/fault-matrix.md", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  const auto hover = rows_of(page, "anaconda, pilot's stick hover");
  const auto idle = rows_of(page, "anaconda, pilot's stick idle");
  std::size_t compared = 0;
  for (const FaultRow& row : fault_rows(true)) {
    if (stick_counts(fixedwing(row.text.c_str()))) continue;
    ++compared;
    EXPECT_EQ(hover.at(row.text), idle.at(row.text)) << row.text;
  }
  EXPECT_EQ(compared, 31U);
  EXPECT_TRUE(stick_counts(multirotor("mag", "idle")));
  EXPECT_TRUE(stick_counts(fixedwing("mag", "crash")));
  EXPECT_FALSE(stick_counts(fixedwing("mag", "baro")));
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

TEST(FaultRules, AVehicleMayStayOnTheGroundForAFaultBeforeLiftOffOnly) {
  for (std::size_t s = 0; s < subjects().size(); ++s) {
    for (const char* phase : subjects()[s].phases) {
      const bool allowed = phase == std::string("armed") || phase == std::string("roll");
      for (const char* fault : {"link_cut:8", "imu_stuck:1", "battery_low"}) {
        const Case c{s, "hover", fault, "", phase, false};
        EXPECT_EQ(explained(c, Class::kNotFlown), allowed) << phase << ' ' << fault;
        EXPECT_EQ(allowed_by(c, Class::kNotFlown), allowed ? Rule::kTakeOffGivenUp : Rule::kNone);
        EXPECT_FALSE(explained(c, Class::kTimeout)) << "with its motors on, or in the air";
      }
      const Case needed{s, "hover", "crash", "", phase, false};
      EXPECT_FALSE(explained(needed, Class::kNotFlown)) << phase << ": the mission has to be done";
    }
  }
  const Case beyond{0, "hover", "gnss", "", kInTheAir, false};
  EXPECT_FALSE(explained(beyond, Class::kNotFlown));
  const Case on_ground{0, "hover", "gnss", "", kOnGround, false};
  EXPECT_TRUE(explained(on_ground, Class::kNotFlown));
  EXPECT_EQ(allowed_by(on_ground, Class::kCrash), Rule::kNone) << "R6 allows no crash";
  EXPECT_EQ(allowed_by(on_ground, Class::kMissionDone), Rule::kNone);
}

Flown flown(const Case& c, Class ended) {
  Flown out;
  out.flight = c;
  out.faults = {at_time(c.first, 20.0)};
  out.ended = ended;
  out.verdict = "verdict";
  return out;
}

TEST(FaultPage, NamesTheRuleOfAVehicleThatStaysOnTheGround) {
  Case roll = fixedwing("link_cut:8");
  roll.phase = "roll";
  const std::string page = as_page({flown(roll, Class::kNotFlown)});
  EXPECT_NE(page.find("| `link_cut:8` | ground R6 |"), std::string::npos) << page;
  EXPECT_NE(page.find("The outcome of such a flight is `timeout`"), std::string::npos);
  EXPECT_NE(page.find("| R6 | The fault began before lift-off"), std::string::npos);
  const std::string leg = as_page({flown(fixedwing("link_cut:8"), Class::kNotFlown)});
  EXPECT_NE(leg.find("ground ?"), std::string::npos) << leg;
  EXPECT_EQ(leg.find("Nothing."), std::string::npos);
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
