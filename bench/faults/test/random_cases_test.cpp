// SPDX-License-Identifier: BSD-3-Clause
// What random flights are drawn from, and how they are judged; no flight.
#include "bench/faults/random_cases.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include "bench/faults/report.hpp"
#include "flight/flight_setup.hpp"
#include "flight/project_root.hpp"
#include "sim/faults.hpp"

namespace rosflight::bench::faults {
namespace {

constexpr std::size_t kMany = 4000;

std::vector<std::string> faults_of(const Case& c) {
  std::vector<std::string> out{c.first};
  if (!c.second.empty()) out.push_back(c.second);
  return out;
}

sim::Fault parsed(const std::string& text) {
  return sim::parse_fault(at_time(text, 0.0));
}

/// The row that a fault was drawn from.
const DrawnKind& kind_of(const std::string& text) {
  const std::string name = text.substr(0, text.find_first_of("=:"));
  const auto& kinds = drawn_kinds();
  const auto found = std::ranges::find_if(kinds, [&name](const DrawnKind& kind) {
    const std::size_t number = kind.name.find('N');
    if (number == std::string::npos) return kind.name == name;
    return name.size() == kind.name.size() &&
           name.substr(0, number) == kind.name.substr(0, number) &&
           name.substr(number + 1) == kind.name.substr(number + 1);
  });
  EXPECT_NE(found, kinds.end()) << text;
  return *found;
}

bool same(const Case& a, const Case& b) {
  return a.subject == b.subject && a.pilot == b.pilot && a.first == b.first &&
         a.second == b.second && a.phase == b.phase && a.seed == b.seed && a.wind == b.wind &&
         a.moments == b.moments && a.second_after_s == b.second_after_s;
}

TEST(RandomCases, AFlightDependsOnTheSeedAndItsNumberAlone) {
  const auto many = random_cases(50, 7, {});
  const auto few = random_cases(10, 7, {});
  for (std::size_t k = 0; k < few.size(); ++k) EXPECT_TRUE(same(few[k], many[k])) << k;
  const auto others = random_cases(50, 8, {});
  EXPECT_FALSE(std::ranges::equal(many, others, same));
}

TEST(RandomCases, TheFirstFlightOfTheFirstSeriesStaysTheSame) {
  const Case first = random_cases(1, 1, {})[0];
  EXPECT_EQ(first.subject, 0U);
  EXPECT_EQ(first.pilot, "hover");
  EXPECT_EQ(first.seed, 155828U);
  EXPECT_EQ(first.wind, "1.0,14,0.3");
  EXPECT_EQ(first.first, "accel_step_x=-0.826");
  EXPECT_EQ(first.second, "link_cut:19.38");
}

TEST(RandomCases, VehiclePilotSeedWindAndNumberOfFaultsAreDrawn) {
  std::map<std::string, double> share;
  std::set<std::uint64_t> seeds;
  for (const Case& c : random_cases(kMany, 1, {})) {
    share[subjects()[c.subject].vehicle] += 1.0 / kMany;
    share[c.pilot] += 1.0 / kMany;
    if (!c.second.empty()) share["pair"] += 1.0 / kMany;
    if (c.second_after_s == 0.0 && !c.second.empty()) share["apart"] += 1.0 / kMany;
    seeds.insert(c.seed);
    EXPECT_GE(c.seed, 1U);
    EXPECT_EQ(c.phase, kRandom);
    EXPECT_FALSE(c.failsafe_command);
    const flight::WindChoice wind = flight::parse_wind(c.wind);
    EXPECT_LE(wind.steady_W_m_s.norm(), subjects()[c.subject].wind_m_s + 1e-9) << c.wind;
    ASSERT_TRUE(wind.w20_m_s) << c.wind;
    EXPECT_LE(*wind.w20_m_s, wind.steady_W_m_s.norm() + 0.05) << "gusts above the wind: " << c.wind;
  }
  constexpr double kFiveSigma = 5.0 * 0.5 / 63.2;  // of a share of one half of 4000
  for (const char* half : {"multirotor", "anaconda", "hover", "idle", "pair"}) {
    EXPECT_NEAR(share[half], 0.5, kFiveSigma) << half;
  }
  EXPECT_NEAR(share["apart"], 0.125, kFiveSigma);
  EXPECT_GT(seeds.size(), kMany * 9 / 10);
}

TEST(RandomCases, TheWindThatIsAskedForIsThatOfAllFlights) {
  const auto own = random_cases(40, 3, {});
  const auto asked = random_cases(40, 3, "4,270,3");
  for (std::size_t k = 0; k < own.size(); ++k) {
    EXPECT_EQ(asked[k].wind, "4,270,3");
    EXPECT_EQ(asked[k].first, own[k].first) << "the rest stays as drawn";
    EXPECT_EQ(asked[k].moments, own[k].moments);
  }
}

TEST(RandomCases, EveryKindIsDrawnWithinItsRange) {
  std::set<std::string> names;
  std::set<sim::FaultKind> kinds;
  for (const Case& c : random_cases(kMany, 1, {})) {
    for (const std::string& text : faults_of(c)) {
      const DrawnKind& kind = kind_of(text);
      names.insert(kind.name);
      const sim::Fault fault = parsed(text);
      kinds.insert(fault.kind);
      if (const auto equals = text.find('='); equals != std::string::npos) {
        const double value = std::stod(text.substr(equals + 1));
        EXPECT_GE(std::abs(value), kind.smallest) << text;
        EXPECT_LE(std::abs(value), kind.largest) << text;
        EXPECT_TRUE(value > 0.0 || kind.both_signs) << text;
      } else {
        EXPECT_EQ(kind.largest, 0.0) << text;
      }
      if (const auto colon = text.find(':'); colon != std::string::npos) {
        const double duration_s = std::stod(text.substr(colon + 1));
        EXPECT_GE(duration_s, kind.shortest_s) << text;
        EXPECT_LE(duration_s, kind.longest_s) << text;
      } else {
        EXPECT_TRUE(kind.longest_s == 0.0 || kind.for_good > 0.0) << text;
      }
    }
  }
  EXPECT_EQ(names.size(), drawn_kinds().size());
  EXPECT_EQ(kinds.size(), sim::kFaultKinds - 1)
      << "all but the loss of motion capture, which no vehicle here has";
}

TEST(RandomCases, MomentsAreUniformOverTheMission) {
  std::array<int, 10> tenths{};
  for (const Case& c : random_cases(kMany, 1, {})) {
    ASSERT_GE(c.moments[0], 0.0);
    ASSERT_LT(c.moments[0], 1.0);
    ++tenths[static_cast<std::size_t>(10.0 * c.moments[0])];
    if (c.second_after_s > 0.0) {
      EXPECT_GE(c.second_after_s, 0.2);
      EXPECT_LE(c.second_after_s, 5.0);
    }
  }
  constexpr double kFiveSigma = 5.0 * 19.0;  // binomial, 4000 of probability 0.1
  for (const int count : tenths) EXPECT_NEAR(count, 400, kFiveSigma);
}

TEST(RandomCases, NoVehicleHasAFaultThatItCannotHave) {
  std::vector<std::unique_ptr<flight::FlightSetup>> setups;
  for (const Subject& subject : subjects()) {
    flight::FlightChoice choice;
    choice.vehicle = subject.vehicle;
    setups.push_back(std::make_unique<flight::FlightSetup>(choice));
    EXPECT_EQ(setups.back()->fixed_wing(), subject.fixed_wing);
    EXPECT_EQ(setups.back()->rotors.rotors.size(), subject.motors);
  }
  std::set<std::string> surfaces;
  std::set<std::string> motors;
  for (const Case& c : random_cases(kMany, 1, {})) {
    for (const std::string& text : faults_of(c)) {
      EXPECT_NO_THROW(setups[c.subject]->check(parsed(text))) << text;
      const bool wing_only = kind_of(text).vehicles == DrawnKind::For::kFixedWing;
      EXPECT_TRUE(!wing_only || subjects()[c.subject].fixed_wing) << text;
      if (text.starts_with("servo")) surfaces.insert(text.substr(0, 6));
      if (text.starts_with("motor")) motors.insert(text.substr(0, 6));
    }
  }
  EXPECT_EQ(surfaces.size(), 3U);
  EXPECT_EQ(motors.size(), 4U);
}

TEST(RandomCases, TheRangesAreThoseOfTheDocuments) {
  std::ifstream stream(flight::project_root() / "docs/faults.md", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(stream), {}};
  for (const DrawnKind& kind : drawn_kinds()) {
    EXPECT_NE(page.find(table_row(kind) + "\n"), std::string::npos) << table_row(kind);
  }
}

Case random_flight(std::size_t subject, const char* first, const char* pilot = "hover") {
  return {subject, pilot, first, "", kRandom, false, 17, "4.0,90,2.0"};
}

TEST(RandomCases, AreJudgedByTheRulesOfTheCampaign) {
  EXPECT_EQ(rule_of(random_flight(0, "motor2_dead:0.61")), Rule::kRotorDead);
  EXPECT_EQ(rule_of(random_flight(0, "imu:0.31")), Rule::kImuGone);
  EXPECT_EQ(rule_of(random_flight(0, "imu:0.29")), Rule::kNone);
  EXPECT_EQ(rule_of(random_flight(0, "gyro_step_y=-0.099")), Rule::kNone);
  EXPECT_EQ(rule_of(random_flight(0, "link_cut:7.13", "idle")), Rule::kPilotHasIt);
}

TEST(RandomCases, TheMissionIsAskedForUpToTheListedSizes) {
  const auto needed = [](std::size_t subject, const char* fault, const char* pilot = "hover") {
    return needs_mission(random_flight(subject, fault, pilot));
  };
  EXPECT_TRUE(needed(0, "gnss:19.99"));
  EXPECT_FALSE(needed(0, "gnss:20.01"));
  EXPECT_TRUE(needed(0, "mag:3.50"));
  EXPECT_TRUE(needed(1, "link_cut:2.99", "idle"));
  EXPECT_FALSE(needed(1, "link_cut:3.01"));
  EXPECT_FALSE(needed(0, "link_cut:2.99", "idle"));
  EXPECT_TRUE(needed(0, "motor3_partial=0.81"));
  EXPECT_FALSE(needed(0, "motor3_partial=0.79"));
  EXPECT_TRUE(needed(0, "link_noise=0.0099"));
  EXPECT_FALSE(needed(1, "rc_silence"));
  EXPECT_FALSE(needed(1, "baro_step=3"));
}

TEST(RandomCases, AFlightThatNoRuleExplainsIsPrintedWithItsCommand) {
  Flown flown;
  flown.flight = random_flight(1, "gnss", "idle");
  flown.faults = {"gnss@20.1234", "mag@22.0000:3.50"};
  flown.ended = Class::kCrash;
  flown.verdict = "Crash: touchdown at 9.00 m/s.";
  flown.without_faults = "mission_done";
  const std::string text = as_random_text({flown});
  EXPECT_NE(text.find("./rosflight fly --vehicle anaconda --pilot idle --seed 17 --wind 4.0,90,2.0 "
                      "--fault gnss@20.1234 --fault mag@22.0000:3.50\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("Crash: touchdown at 9.00 m/s. Without its faults: mission_done."),
            std::string::npos);
  EXPECT_NE(text.find("anaconda, one fault: 1 crash ?"), std::string::npos);
}

}  // namespace
}  // namespace rosflight::bench::faults
