// SPDX-License-Identifier: BSD-3-Clause
// Page, table and comparison of the fault campaign; no flight.
#include "bench/faults/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/faults/test/leg_cases.hpp"

namespace rosflight::bench::faults {
namespace {

Flown flown(const Case& c, Class ended) {
  Flown out;
  out.flight = c;
  out.faults = {at_time(c.first, 20.0)};
  out.ended = ended;
  out.verdict = "verdict";
  return out;
}

/// The fields of a row of a table with commas; those in quotes may contain some.
std::vector<std::string> fields(const std::string& row) {
  std::vector<std::string> out{""};
  bool quoted = false;
  for (const char c : row) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

TEST(FaultTable, HasARowForEachFlightAndAFieldForEachName) {
  Case pair = fixedwing("gnss", "mag");
  pair.pilot = "idle";
  pair.seed = 12;
  pair.wind = "4.0,270,2.0";
  Flown second = flown(pair, Class::kHardLanding);
  second.faults.push_back(at_time(pair.second, 21.0));
  second.verdict = "Hard landing: touchdown at 2.50 m/s, 2 m/s allowed.";
  second.touchdown_m_s = 2.5;
  second.from_aim_m = std::numeric_limits<double>::quiet_NaN();
  second.estimate.samples = 10;
  second.estimate.outside[6] = 4;
  second.estimate.far = 1;
  std::istringstream lines(
      as_csv({flown(multirotor("imu_stuck:1"), Class::kCrash), std::move(second)}));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(fields(line));
  ASSERT_EQ(rows.size(), 3U);
  const auto field = [&rows](std::size_t row, const std::string& name) {
    const auto at = std::ranges::find(rows[0], name) - rows[0].begin();
    return rows[row].at(static_cast<std::size_t>(at));
  };
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(field(1, "vehicle"), "multirotor");
  EXPECT_EQ(field(1, "rule"), "R3");
  EXPECT_EQ(field(1, "explained"), "1");
  EXPECT_EQ(field(1, "second"), "");
  EXPECT_EQ(field(2, "vehicle"), "anaconda");
  EXPECT_EQ(field(2, "pilot"), "idle");
  EXPECT_EQ(field(2, "seed"), "12");
  EXPECT_EQ(field(2, "wind"), "4.0,270,2.0");
  EXPECT_EQ(field(2, "phase"), "leg");
  EXPECT_EQ(field(2, "faults"), "gnss@20.0000 mag@21.0000");
  EXPECT_EQ(field(2, "class"), "hard");
  EXPECT_EQ(field(2, "rule"), "");
  EXPECT_EQ(field(2, "explained"), "0");
  EXPECT_EQ(field(2, "touchdown_m_s"), "2.50");
  EXPECT_EQ(field(2, "from_aim_m"), "") << "there is none";
  EXPECT_EQ(field(2, "outside_state"), "roll");
  EXPECT_EQ(field(2, "outside_share"), "0.4000");
  EXPECT_EQ(field(2, "far"), "1");
  EXPECT_EQ(field(2, "said_in_time"), "0");
  EXPECT_EQ(field(2, "verdict"), "Hard landing: touchdown at 2.50 m/s, 2 m/s allowed.");
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
