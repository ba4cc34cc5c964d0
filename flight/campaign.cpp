// SPDX-License-Identifier: BSD-3-Clause
#include "flight/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "base/constants.hpp"

namespace rosflight::flight {
namespace {

using config::Error;

constexpr std::uint64_t kMaxFlights = 1'000'000;

/// The work that the threads share.
class Campaign {
 public:
  explicit Campaign(const CampaignOptions& options)
      : options_{options}, summaries_(options.last_seed - options.first_seed + 1) {}

  /// Flies until no seed is left. A thread that fails ends the others.
  void work() {
    try {
      FlightSetup setup(options_.choice);
      for (std::size_t k = next_++; k < summaries_.size() && !stop_; k = next_++) {
        setup.choice.seed = options_.first_seed + k;
        fly(setup, k);
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      error_ = std::current_exception();
      stop_ = true;
    }
  }

  std::vector<FlightSummary> result() {
    if (error_) std::rethrow_exception(error_);
    std::vector<FlightSummary> out;
    for (auto& summary : summaries_) {
      if (summary) out.push_back(std::move(*summary));
    }
    return out;
  }

 private:
  void fly(const FlightSetup& setup, std::size_t k) {
    const auto flight = std::make_unique<Flight>(setup);
    while (!flight->finished()) {
      if (stop_ || (options_.interrupted && options_.interrupted())) {
        stop_ = true;
        return;
      }
      flight->step();
    }
    FlightSummary summary = summarise(*flight);
    const std::lock_guard lock(mutex_);
    summaries_[k] = std::move(summary);
    ++done_;
    if (options_.on_flight) options_.on_flight(done_);
  }

  const CampaignOptions& options_;
  std::vector<std::optional<FlightSummary>> summaries_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::size_t done_{0};
  std::exception_ptr error_;
};

/// Six digits after the point; nothing if it does not exist.
std::string cell(double value) {
  return std::isfinite(value) ? fmt::format("{:.6f}", value) : "";
}

/// Distance to the waypoint that was missed by most; NaN where one was never flown to.
double worst_waypoint_m(const FlightScore& score) {
  double worst = 0.0;
  for (const WaypointPass& pass : score.waypoints) {
    if (!std::isfinite(pass.truth_distance_m)) return ErrorStatistics::kNone;
    worst = std::max(worst, pass.truth_distance_m);
  }
  return worst;
}

}  // namespace

std::vector<FlightSummary> fly_campaign(const CampaignOptions& options) {
  if (options.choice.board != "in_process" || options.choice.link != "cable") {
    throw Error(fmt::format("--seeds: found --board {} --link {}, allowed in_process and cable",
                            options.choice.board, options.choice.link));
  }
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  const std::uint64_t flights = options.last_seed - options.first_seed + 1;
  const auto threads = static_cast<unsigned>(
      std::min<std::uint64_t>(options.threads == 0 ? processors : options.threads, flights));
  Campaign campaign(options);
  std::vector<std::thread> helpers;
  for (unsigned k = 1; k < threads; ++k) helpers.emplace_back([&campaign] { campaign.work(); });
  campaign.work();
  for (std::thread& helper : helpers) helper.join();
  return campaign.result();
}

std::string campaign_csv(const std::vector<FlightSummary>& flights) {
  std::string out =
      "seed,outcome,success,waypoints_reached,waypoints_total,worst_waypoint_m,tracking_rms_m,"
      "tracking_max_m,touchdown_speed_m_s,touchdown_tilt_deg,touchdown_distance_m,flight_time_s,"
      "sim_time_s\n";
  for (const FlightSummary& s : flights) {
    const auto& touchdown = s.score.landing.touchdown();
    const double none = ErrorStatistics::kNone;
    out += fmt::format("{},{},{:d},{},{}", s.choice.seed, outcome_name(s.score.outcome),
                       s.score.success(), s.score.waypoints_reached(), s.score.waypoints.size());
    for (const double value :
         {worst_waypoint_m(s.score), s.tracking.rms(), s.tracking.largest(),
          touchdown ? touchdown->speed_m_s : none,
          touchdown ? touchdown->tilt_rad / base::kRadPerDeg : none,
          s.score.landing.distance_m(s.score.limits), s.flight_time_s, s.sim_time_s}) {
      out += "," + cell(value);
    }
    out += "\n";
  }
  return out;
}

void read_seeds(const std::string& text, CampaignOptions& options) {
  const auto number = [](std::string_view word) -> std::optional<std::uint64_t> {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc{} || end != word.data() + word.size()) return {};
    return value;
  };
  const std::string_view whole = text;
  const std::size_t colon = whole.find(':');
  const auto first = number(whole.substr(0, colon));
  const auto last = colon == std::string_view::npos ? first : number(whole.substr(colon + 1));
  if (!first || !last || *last < *first || *last - *first >= kMaxFlights) {
    throw Error(fmt::format("--seeds: found '{}', allowed FIRST:LAST of at most {} seeds", text,
                            kMaxFlights));
  }
  options.first_seed = *first;
  options.last_seed = *last;
}

}  // namespace rosflight::flight
