// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/flights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>

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

double first_begin_s(const sim::FaultSchedule& faults) {
  sim::Time first = sim::Time::max();
  for (const sim::Fault& fault : faults.faults()) first = std::min(first, fault.start);
  return sim::to_seconds(first);
}

/// Flies cases one after the other; keeps the set-ups of the campaign's flights. Of one thread.
class Hangar {
 public:
  explicit Hangar(const std::map<Key, Nominal>& nominal) : nominal_{nominal} {}

  Flown fly(const Case& wanted) {
    Flown out;
    out.flight = wanted;
    out.faults = timed(wanted, nominal_.at(key_of(wanted)).phases);
    const bool random = wanted.phase == kRandom;
    std::unique_ptr<FlightSetup> own;
    if (random) own = std::make_unique<FlightSetup>(choice_of(wanted));
    FlightSetup& setup = random ? *own : kept(wanted);
    setup.faults = sim::parse_faults(out.faults);
    fly(setup, out);
    if (random && !out.as_asked()) {
      setup.faults = {};
      const auto plain = std::make_unique<Flight>(setup);
      plain->run();
      out.without_faults = flight::outcome_name(plain->score().outcome);
    }
    return out;
  }

 private:
  static void fly(const FlightSetup& setup, Flown& out) {
    const auto flight = std::make_unique<Flight>(setup);
    EstimateWatch watch(first_begin_s(setup.faults));
    flight->set_script([&watch](Flight& f, sim::Time t) { watch.look(f, t); });
    flight->run();
    const flight::FlightScore score = flight->score();
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    out.ended = class_of(score, flight->runner().disarmed());
    out.verdict = score.verdict;
    out.touchdown_m_s = score.landing.touchdown() ? score.landing.touchdown()->hardest_m_s : kNone;
    out.from_aim_m = score.landing.distance_m(score.limits);
    out.sim_time_s = sim::to_seconds(flight->now());
    out.estimate = watch.count();
    if (out.flight.phase == kRandom) {
      out.flight.phase = watch.began_on_ground() ? kOnGround : kInTheAir;
    }
  }

  FlightSetup& kept(const Case& wanted) {
    auto& setup = setups_[key_of(wanted)];
    if (!setup) setup = std::make_unique<FlightSetup>(choice_of(wanted));
    return *setup;
  }

  const std::map<Key, Nominal>& nominal_;
  std::map<Key, std::unique_ptr<FlightSetup>> setups_;
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

Campaign fly(const std::vector<Case>& cases, unsigned threads,
             const std::function<void(std::size_t)>& progress) {
  const std::map<Key, Nominal> nominal = fly_without_faults(cases, threads);
  Campaign out;
  out.nominal = nominal.size();
  out.nominal_said = static_cast<std::size_t>(
      std::ranges::count_if(nominal, [](const auto& entry) { return entry.second.said; }));
  out.flights.resize(cases.size());
  std::mutex mutex;
  std::size_t done = 0;
  in_parallel(cases.size(), threads, [&] {
    return [&, hangar = std::make_shared<Hangar>(nominal)](std::size_t k) {
      out.flights[k] = hangar->fly(cases[k]);
      const std::lock_guard lock(mutex);
      progress(++done);
    };
  });
  return out;
}

}  // namespace rosflight::bench::faults
