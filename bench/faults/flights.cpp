// SPDX-License-Identifier: BSD-3-Clause
#include "bench/faults/flights.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>

#include "bench/faults/phases.hpp"

namespace rosflight::bench::faults {
namespace {

using flight::FlightSetup;
using flight::Outcome;

constexpr const char* kFailsafeCommand = "firmware.FAILSAFE_OFFBRD=0";

flight::FlightChoice choice_of(const Case& flown) {
  flight::FlightChoice choice;
  choice.vehicle = subjects()[flown.subject].vehicle;
  choice.pilot = flown.pilot;
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

/// Set-ups and times of phases, read and flown once for each kind of flight. Of one thread.
class Hangar {
 public:
  Flown fly(const Case& wanted) {
    Prepared& ready = prepared(wanted);
    Flown out;
    out.flight = wanted;
    const double t_s = ready.phases.at(wanted.phase);
    out.faults.push_back(at_time(wanted.first, t_s));
    if (!wanted.second.empty()) out.faults.push_back(at_time(wanted.second, t_s + 1.0));
    ready.setup->faults = sim::parse_faults(out.faults);
    const auto flight = std::make_unique<flight::Flight>(*ready.setup);
    flight->run();
    const flight::FlightScore score = flight->score();
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    out.ended = class_of(score, flight->runner().disarmed());
    out.verdict = score.verdict;
    out.touchdown_m_s = score.landing.touchdown() ? score.landing.touchdown()->hardest_m_s : kNone;
    out.from_aim_m = score.landing.distance_m(score.limits);
    out.sim_time_s = sim::to_seconds(flight->now());
    return out;
  }

 private:
  struct Prepared {
    std::unique_ptr<FlightSetup> setup;
    PhaseTimes phases;
  };

  Prepared& prepared(const Case& wanted) {
    const auto key = std::tuple(wanted.subject, wanted.pilot, wanted.failsafe_command);
    const auto [entry, fresh] = ready_.try_emplace(key);
    if (fresh) {
      entry->second.setup = std::make_unique<FlightSetup>(choice_of(wanted));
      entry->second.phases = find_phases(*entry->second.setup);
    }
    return entry->second;
  }

  std::map<std::tuple<std::size_t, std::string, bool>, Prepared> ready_;
};

/// The work that the threads share.
class Campaign {
 public:
  Campaign(const std::vector<Case>& cases, const std::function<void(std::size_t)>& progress)
      : cases_{cases}, progress_{progress}, flown_(cases.size()) {}

  /// Flies until no case is left. A thread that fails ends the others.
  void work() {
    try {
      Hangar hangar;
      for (std::size_t k = next_++; k < cases_.size() && !stop_; k = next_++) {
        flown_[k] = hangar.fly(cases_[k]);
        const std::lock_guard lock(mutex_);
        progress_(++done_);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      error_ = std::current_exception();
      stop_ = true;
    }
  }

  std::vector<Flown> result() {
    if (error_) std::rethrow_exception(error_);
    return std::move(flown_);
  }

 private:
  const std::vector<Case>& cases_;
  const std::function<void(std::size_t)>& progress_;
  std::vector<Flown> flown_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::size_t done_{0};
  std::exception_ptr error_;
};

}  // namespace

std::string command(const Flown& flown) {
  const Case& c = flown.flight;
  std::string out = "./rosflight fly";
  if (c.subject > 0) out += fmt::format(" --vehicle {}", subjects()[c.subject].vehicle);
  if (c.pilot != "hover") out += " --pilot " + c.pilot;
  if (c.failsafe_command) out += fmt::format(" --set {}", kFailsafeCommand);
  for (const std::string& fault : flown.faults) out += " --fault " + fault;
  return out;
}

std::vector<Flown> fly(const std::vector<Case>& cases, unsigned threads,
                       const std::function<void(std::size_t)>& progress) {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const unsigned wanted = threads == 0 ? processors : threads;
  Campaign campaign(cases, progress);
  std::vector<std::thread> helpers;
  for (unsigned k = 1; k < wanted; ++k) helpers.emplace_back([&campaign] { campaign.work(); });
  campaign.work();
  for (std::thread& helper : helpers) helper.join();
  return campaign.result();
}

}  // namespace rosflight::bench::faults
