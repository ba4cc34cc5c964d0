// SPDX-License-Identifier: BSD-3-Clause
// The campaign's flights: when their phases are, that they repeat, and what the estimate watch counts.
#include "bench/faults/flights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <sstream>
#include <vector>

#include "bench/faults/phases.hpp"
#include "bench/faults/random_cases.hpp"

namespace rosflight::bench::faults {
namespace {

using flight::Flight;
using flight::FlightChoice;
using flight::FlightSetup;

/// The true motion and what guidance does at a moment.
struct Seen {
  bool on_ground{};
  double altitude_m{};
  double climb_m_s{};
  double speed_m_s{};  ///< Over the ground.
  double bank_rad{};
  std::string phase;
  std::size_t waypoint{};
  double passed_m{};  ///< Horizontal distance from the waypoint before `waypoint`.
  double next_m{};
};

FlightChoice default_flight(const Subject& subject) {
  FlightChoice choice;
  choice.vehicle = subject.vehicle;
  return choice;
}

/// Flies the default flight again and looks at each phase.
std::map<std::string, Seen> look_at(const FlightSetup& setup, const Phases& phases) {
  std::map<std::string, Seen> out;
  const auto flight = std::make_unique<Flight>(setup);
  flight->set_script([&](Flight& f, sim::Time t) {
    for (const auto& [name, begin_s] : phases.begin_s) {
      if (sim::to_seconds(t) < begin_s || out.contains(name)) continue;
      const sim::BodyState& body = f.truth().body;
      const sim::Vector3 v_W = body.q_WB * body.v_B;
      const sim::Vector3 right_W = body.q_WB * sim::Vector3::UnitY();
      const std::size_t next = f.autonomy().waypoint;
      const auto away = [&](std::size_t k) {
        return (setup.waypoints.at(k).p_W - body.p_W).head<2>().norm();
      };
      out[name] = {f.truth().on_ground,
                   -body.p_W.z(),
                   -v_W.z(),
                   v_W.head<2>().norm(),
                   std::asin(right_W.z()),
                   f.autonomy().phase,
                   next,
                   next > 0 ? away(next - 1) : 0.0,
                   next < setup.waypoints.size() ? away(next) : 0.0};
    }
  });
  flight->run();
  return out;
}

void expect_all_phases(const Subject& subject, const Phases& phases) {
  EXPECT_EQ(phases.begin_s.size(), subject.phases.size());
  for (const char* phase : subject.phases) EXPECT_TRUE(phases.begin_s.contains(phase)) << phase;
  for (const auto& [name, begin_s] : phases.begin_s) {
    EXPECT_GT(begin_s, phases.armed_s) << name;
    EXPECT_LT(begin_s, phases.touchdown_s) << name;
  }
}

TEST(FaultPhases, OfAMultirotorAreWhatTheirNamesSay) {
  const FlightSetup setup(default_flight(subjects()[0]));
  const Phases phases = find_phases(setup);
  expect_all_phases(subjects()[0], phases);
  const auto seen = look_at(setup, phases);

  EXPECT_TRUE(seen.at("armed").on_ground);
  EXPECT_NEAR(phases.begin_s.at("armed"), phases.armed_s, 0.1);

  EXPECT_FALSE(seen.at("take-off").on_ground);
  EXPECT_EQ(seen.at("take-off").phase, "takeoff");
  EXPECT_GT(seen.at("take-off").climb_m_s, 0.2);
  EXPECT_LT(seen.at("take-off").altitude_m, 2.5) << "the take-off ends there";

  EXPECT_EQ(seen.at("hold").phase, "position_hold");
  EXPECT_LT(seen.at("hold").speed_m_s, 0.3);

  EXPECT_EQ(seen.at("leg").waypoint, 1U);
  EXPECT_GT(seen.at("leg").speed_m_s, 2.0);
  EXPECT_GT(seen.at("leg").passed_m, 3.0);
  EXPECT_GT(seen.at("leg").next_m, 3.0);

  EXPECT_EQ(seen.at("turn").waypoint, 2U);
  EXPECT_LT(seen.at("turn").passed_m, 1.5);

  EXPECT_EQ(seen.at("landing").phase, "landing");
  EXPECT_LT(seen.at("landing").climb_m_s, -0.2);
  EXPECT_GT(seen.at("landing").altitude_m, 0.8);

  EXPECT_EQ(seen.at("touch").phase, "landing");
  EXPECT_FALSE(seen.at("touch").on_ground);
  EXPECT_LT(seen.at("touch").altitude_m, 0.4);
}

TEST(FaultPhases, OfAFixedWingAreWhatTheirNamesSay) {
  const FlightSetup setup(default_flight(subjects()[1]));
  const Phases phases = find_phases(setup);
  expect_all_phases(subjects()[1], phases);
  const auto seen = look_at(setup, phases);

  EXPECT_TRUE(seen.at("roll").on_ground);
  EXPECT_EQ(seen.at("roll").phase, "takeoff");
  EXPECT_GT(seen.at("roll").speed_m_s, 1.0);

  EXPECT_FALSE(seen.at("lift").on_ground);
  EXPECT_EQ(seen.at("lift").phase, "takeoff");
  EXPECT_LT(seen.at("lift").altitude_m, 3.0);

  EXPECT_EQ(seen.at("climb").phase, "climb");
  EXPECT_GT(seen.at("climb").climb_m_s, 1.0);

  EXPECT_EQ(seen.at("leg").waypoint, 1U);
  EXPECT_LT(std::abs(seen.at("leg").bank_rad), 0.1);
  EXPECT_GT(seen.at("leg").passed_m, 200.0);
  EXPECT_GT(seen.at("leg").next_m, 200.0);

  EXPECT_EQ(seen.at("arc").waypoint, 1U);
  EXPECT_LT(seen.at("arc").passed_m, 120.0);
  EXPECT_LT(phases.begin_s.at("arc"), phases.begin_s.at("leg"));

  EXPECT_EQ(seen.at("approach").phase, "approach");
  EXPECT_LT(seen.at("approach").climb_m_s, -0.3);

  EXPECT_EQ(seen.at("flare").phase, "flare");
  EXPECT_FALSE(seen.at("flare").on_ground);
  EXPECT_LT(seen.at("flare").altitude_m, 5.0);
}

std::vector<Flown> flown(const std::vector<Case>& cases, unsigned processes) {
  return fly(cases, processes, [](std::size_t) {}).flights;
}

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void expect_same(const Flown& a, const Flown& b) {
  EXPECT_EQ(command(a), command(b));
  EXPECT_EQ(a.ended, b.ended) << command(a);
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_TRUE(same_number(a.touchdown_m_s, b.touchdown_m_s)) << command(a);
  EXPECT_TRUE(same_number(a.from_aim_m, b.from_aim_m)) << command(a);
  EXPECT_EQ(a.sim_time_s, b.sim_time_s);
  EXPECT_EQ(a.estimate.samples, b.estimate.samples);
  EXPECT_EQ(a.estimate.outside, b.estimate.outside);
  EXPECT_EQ(a.flight.phase, b.flight.phase);
}

TEST(FaultFlights, DoNotDependOnTheNumberOfProcesses) {
  std::vector<Case> cases = random_cases(6, 1, {});
  cases.push_back({0, "hover", "link_cut:3", "", "leg", false});
  cases.push_back({0, "idle", "mag", "gnss:20", "landing", false});
  const auto one = flown(cases, 1);
  const auto three = flown(cases, 3);
  ASSERT_EQ(one.size(), three.size());
  for (std::size_t k = 0; k < one.size(); ++k) expect_same(one[k], three[k]);
}

/// What `./rosflight fly` makes of a printed command.
FlightChoice choice_of(const std::string& command_line) {
  FlightChoice choice;
  std::istringstream words(command_line);
  std::string word;
  std::string value;
  words >> word >> word;  // ./rosflight fly
  while (words >> word >> value) {
    if (word == "--vehicle") choice.vehicle = value;
    if (word == "--pilot") choice.pilot = value;
    if (word == "--seed") choice.seed = std::stoull(value);
    if (word == "--wind") choice.wind = value;
    if (word == "--set") choice.overrides.push_back(value);
    if (word == "--fault") choice.faults.push_back(value);
  }
  return choice;
}

TEST(FaultFlights, ThePrintedCommandRepeatsThemToTheBit) {
  std::vector<Case> cases = random_cases(4, 2, {});
  cases.push_back({0, "hover", "rc_silence:2", "", "leg", true});
  for (const Flown& before : flown(cases, 0)) {
    const FlightSetup setup(choice_of(command(before)));
    const auto flight = std::make_unique<Flight>(setup);
    flight->run();
    const flight::FlightScore score = flight->score();
    EXPECT_EQ(score.verdict, before.verdict) << command(before);
    EXPECT_EQ(sim::to_seconds(flight->now()), before.sim_time_s);
    EXPECT_TRUE(same_number(score.landing.distance_m(score.limits), before.from_aim_m));
  }
}

TEST(FaultFlights, ARandomFlightSaysWhereItsFaultBegan) {
  Case early{0, "hover", "battery", "", kRandom, false, 3, "2.0,90,1.0"};
  early.moments = {0.001, 0.0};  // 0.05 s after arming
  Case late = early;
  late.moments = {0.5, 0.0};
  const auto done = flown({early, late}, 1);
  EXPECT_EQ(done[0].flight.phase, kBeforeLiftOff);
  EXPECT_EQ(done[1].flight.phase, kAfterLiftOff);
  EXPECT_EQ(done[0].ended, Class::kMissionDone);
  EXPECT_EQ(done[0].faults[0].substr(0, 8), "battery@");
}

TEST(FaultFlights, TheEstimateIsWatchedFromTheFaultOn) {
  const auto done = flown(
      {{0, "hover", "battery", "", "armed", false}, {0, "hover", "battery", "", "landing", false}},
      1);
  EXPECT_GT(done[0].estimate.samples, 600U) << "twenty samples a second of some 50 s";
  EXPECT_GT(done[1].estimate.samples, 10U);
  EXPECT_LT(done[1].estimate.samples, 200U);
  EXPECT_EQ(done[0].estimate.said, 0U);
}

}  // namespace
}  // namespace rosflight::bench::faults
