// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/flights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "bench/faults/children.hpp"
#include "bench/faults/phases.hpp"
#include "bench/in_parallel.hpp"

namespace rosflight::bench::faults {
namespace {

using flight::Flight;
using flight::FlightSetup;
using flight::Outcome;

constexpr const char* kFailsafeCommand = "firmware.FAILSAFE_OFFBRD=0";

flight::FlightChoice choice_of(const Case& flown) {
  flight::FlightChoice choice;
  choice.vehicle = subjects()[flown.subject].vehicle;
  choice.pilot = flown.pilot;
  choice.seed = flown.seed;
  if (!flown.wind.empty()) choice.wind = flown.wind;
  if (flown.failsafe_command) choice.overrides = {kFailsafeCommand};
  return choice;
}

Class class_of(const flight::FlightScore& score, bool disarmed) {
  switch (score.outcome) {
    case Outcome::kMissionDone:
      return Class::kMissionDone;
    case Outcome::kLandedElsewhere:
      return Class::kLandedElsewhere;
    case Outcome::kHardLanding:
      return Class::kHardLanding;
    case Outcome::kCrash:
      return Class::kCrash;
    default:
      return !score.landing.airborne() && disarmed ? Class::kNotFlown : Class::kTimeout;
  }
}

/// What flights have in common whose set-ups differ in their faults alone, in calm air with seed 1.
using Key = std::tuple<std::size_t, std::string, bool>;

Key key_of(const Case& c) {
  return {c.subject, c.pilot, c.failsafe_command};
}

struct Nominal {
  Phases phases;
  bool said{};  ///< The estimate reported an unreliable position.
};

/// The flights without faults that these cases need.
std::map<Key, Nominal> fly_without_faults(const std::vector<Case>& cases, unsigned threads) {
  std::map<Key, Nominal> found;
  for (const Case& c : cases) found.try_emplace(key_of(c));
  std::vector<std::pair<const Key, Nominal>*> list;
  list.reserve(found.size());
  for (auto& entry : found) list.push_back(&entry);
  in_parallel(list.size(), threads, [&] {
    return [&list](std::size_t k) {
      Case plain;
      std::tie(plain.subject, plain.pilot, plain.failsafe_command) = list[k]->first;
      EstimateWatch watch(0.0);
      const auto look = [&watch](Flight& f, sim::Time t) { watch.look(f, t); };
      list[k]->second.phases = find_phases(FlightSetup(choice_of(plain)), look);
      list[k]->second.said = watch.count().said > 0;
    };
  });
  return found;
}

/// The faults of a case with their times, as `--fault` takes them.
std::vector<std::string> timed(const Case& wanted, const Phases& phases) {
  const bool random = wanted.phase == kRandom;
  const auto at = [&phases](double moment) {
    return phases.armed_s + moment * (phases.touchdown_s - phases.armed_s);
  };
  const double first_s = random ? at(wanted.moments[0]) : phases.begin_s.at(wanted.phase);
  std::vector<std::string> out{at_time(wanted.first, first_s)};
  if (wanted.second.empty()) return out;
  const double after_s = random ? wanted.second_after_s : 1.0;
  out.push_back(at_time(wanted.second, after_s > 0.0 ? first_s + after_s : at(wanted.moments[1])));
  return out;
}

/// The fault is added so long before it begins, so that the watch sees all that it keeps.
constexpr double kBefore_s = EstimateWatch::kKept_s + 0.1;

double first_begin_s(const sim::FaultSchedule& faults) {
  sim::Time first = sim::Time::max();
  for (const sim::Fault& fault : faults.faults()) first = std::min(first, fault.start);
  return sim::to_seconds(first);
}

/// Flies to the end, with the faults that the flight has.
void finish(Flight& flight, Flown& out) {
  EstimateWatch watch(first_begin_s(flight.faults()));
  flight.set_script([&watch](Flight& f, sim::Time t) { watch.look(f, t); });
  flight.run();
  const flight::FlightScore score = flight.score();
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  out.ended = class_of(score, flight.runner().disarmed());
  out.verdict = score.verdict;
  out.touchdown_m_s = score.landing.touchdown() ? score.landing.touchdown()->hardest_m_s : kNone;
  out.from_aim_m = score.landing.distance_m(score.limits);
  out.sim_time_s = sim::to_seconds(flight.now());
  out.estimate = watch.count();
  if (out.flight.phase == kRandom) {
    out.flight.phase = watch.began_before_lift_off() ? kBeforeLiftOff : kAfterLiftOff;
  }
}

nlohmann::json number(double value) {
  return std::isnan(value) ? nlohmann::json() : nlohmann::json(value);
}
double number(const nlohmann::json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

/// What a flight adds to its case, as one line.
std::string line_of(const Flown& f) {
  return nlohmann::json{f.ended,
                        f.verdict,
                        number(f.touchdown_m_s),
                        number(f.from_aim_m),
                        f.sim_time_s,
                        f.without_faults,
                        f.flight.phase,
                        f.estimate.samples,
                        f.estimate.outside,
                        f.estimate.far,
                        f.estimate.in_time,
                        f.estimate.said}
      .dump();
}

void read_line(const std::string& line, Flown& f) {
  const auto json = nlohmann::json::parse(line);
  f.ended = json[0].get<Class>();
  f.verdict = json[1];
  f.touchdown_m_s = number(json[2]);
  f.from_aim_m = number(json[3]);
  f.sim_time_s = json[4];
  f.without_faults = json[5];
  f.flight.phase = json[6];
  f.estimate.samples = json[7];
  f.estimate.outside = json[8];
  f.estimate.far = json[9];
  f.estimate.in_time = json[10];
  f.estimate.said = json[11];
}

/// Flies cases one after the other, in one process. Flights of the campaign are equal until their first fault:
/// each way to a phase is flown once and kept, and every flight goes on from a copy of it in a child.
class Hangar {
 public:
  explicit Hangar(const std::map<Key, Nominal>& nominal) : nominal_{nominal} {}

  Flown fly(const Case& wanted) {
    Flown out;
    out.flight = wanted;
    out.faults = timed(wanted, nominal_.at(key_of(wanted)).phases);
    const sim::FaultSchedule faults = sim::parse_faults(out.faults);
    if (wanted.phase == kRandom) {
      fly_alone(faults, out);
      return out;
    }
    Flight& before = flown_until(wanted, first_begin_s(faults) - kBefore_s);
    const std::string line = in_child([&] {
      for (const sim::Fault& fault : faults.faults()) before.faults().add(fault);
      finish(before, out);
      return line_of(out);
    });
    read_line(line, out);
    return out;
  }

 private:
  static void fly_alone(const sim::FaultSchedule& faults, Flown& out) {
    FlightSetup setup(choice_of(out.flight));
    setup.faults = faults;
    finish(*std::make_unique<Flight>(setup), out);
    if (out.as_asked()) return;
    setup.faults = {};
    const auto plain = std::make_unique<Flight>(setup);
    plain->run();
    out.without_faults = flight::outcome_name(plain->score().outcome);
  }

  Flight& flown_until(const Case& wanted, double until_s) {
    auto& setup = setups_[key_of(wanted)];
    if (!setup) setup = std::make_unique<FlightSetup>(choice_of(wanted));
    auto& flight = flights_[{key_of(wanted), wanted.phase}];
    if (!flight) flight = std::make_unique<Flight>(*setup);
    while (sim::to_seconds(flight->now()) < until_s) flight->step();
    return *flight;
  }

  const std::map<Key, Nominal>& nominal_;
  std::map<Key, std::unique_ptr<FlightSetup>> setups_;
  std::map<std::pair<Key, std::string>, std::unique_ptr<Flight>> flights_;
};

}  // namespace

std::string command(const Flown& flown) {
  const Case& c = flown.flight;
  std::string out = "./rosflight fly";
  if (c.subject > 0) out += fmt::format(" --vehicle {}", subjects()[c.subject].vehicle);
  if (c.pilot != "hover") out += " --pilot " + c.pilot;
  if (c.seed != 1) out += fmt::format(" --seed {}", c.seed);
  if (!c.wind.empty()) out += " --wind " + c.wind;
  if (c.failsafe_command) out += fmt::format(" --set {}", kFailsafeCommand);
  for (const std::string& fault : flown.faults) out += " --fault " + fault;
  return out;
}

Campaign fly(const std::vector<Case>& cases, unsigned processes,
             const std::function<void(std::size_t)>& progress) {
  const std::map<Key, Nominal> nominal = fly_without_faults(cases, processes);
  Campaign out;
  out.nominal = nominal.size();
  out.nominal_said = static_cast<std::size_t>(
      std::ranges::count_if(nominal, [](const auto& entry) { return entry.second.said; }));
  out.flights.resize(cases.size());
  Hangar hangar(nominal);
  std::size_t done = 0;
  in_children(
      cases.size(), processes, [&](std::size_t k) { return line_of(hangar.fly(cases[k])); },
      [&](std::size_t k, const std::string& line) {
        Flown& flown = out.flights[k];
        flown.flight = cases[k];
        flown.faults = timed(cases[k], nominal.at(key_of(cases[k])).phases);
        read_line(line, flown);
        progress(++done);
      });
  return out;
}

}  // namespace rosflight::bench::faults
