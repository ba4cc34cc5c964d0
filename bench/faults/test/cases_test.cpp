// SPDX-License-Identifier: BSD-3-Clause
// What the fault campaign flies, and which part of it continuous integration; no flight.
#include "bench/faults/cases.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/faults/test/leg_cases.hpp"
#include "sim/faults.hpp"

namespace rosflight::bench::faults {
namespace {

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
            (m + w) * 2 * 7);
  EXPECT_EQ(count([](const Case& c) { return c.failsafe_command; }), 2 * 7 * 3);
  const auto kinds = [](bool fixed_wing) {
    const auto rows = fault_rows(fixed_wing);
    return std::ranges::count_if(rows, [](const FaultRow& row) { return row.first_of_kind; });
  };
  const auto pairs = [](std::ptrdiff_t n) { return n * (n - 1); };  // in both orders
  EXPECT_EQ(count([](const Case& c) { return !c.second.empty(); }),
            (pairs(kinds(false)) + pairs(kinds(true))) * 2 * 2);
}

TEST(FaultCases, EveryPairIsFlownInBothOrdersInEveryPhaseWithBothPilots) {
  std::set<std::string> all;
  for (const Case& c : all_cases())
    EXPECT_TRUE(all.insert(label(c)).second) << label(c) << " twice";
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

TEST(FaultQuarter, IsAQuarterOfTheFlightsWithEitherOrderOfAPairCountedOnce) {
  std::set<std::string> all;
  std::size_t singles = 0;
  std::size_t failsafe = 0;
  std::set<std::string> pairs;
  for (const Case& c : all_cases()) {
    all.insert(label(c));
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
  EXPECT_NEAR(share(flown[2], pairs.size()), 0.25, 0.01);
}

TEST(FaultQuarter, TheBlocksOfAVehicleTogetherFlyEachPairOnce) {
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
    EXPECT_EQ(covered, all) << "each pair in one of the blocks";
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

}  // namespace
}  // namespace rosflight::bench::faults
