// SPDX-License-Identifier: BSD-3-Clause
#include "apps/campaign_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <vector>

#include "base/atomic_file.hpp"
#include "base/stop_signal.hpp"
#include "flight/campaign.hpp"

namespace rosflight::apps {
namespace {

using flight::FlightSummary;

/// One line: median, 95 of 100, largest.
template <class Get>
void print_quantiles(std::ostream& out, const char* what, const char* unit,
                     const std::vector<FlightSummary>& flights, Get get) {
  std::vector<double> values;
  for (const FlightSummary& s : flights) {
    if (const double value = get(s); std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) {
    fmt::print(out, "{:<26}–\n", what);
    return;
  }
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  fmt::print(out, "{:<26}{:8.2f} {:8.2f} {:8.2f} {}\n", what, at(0.5), at(0.95), values.back(),
             unit);
}

void print_statistics(std::ostream& out, const std::vector<FlightSummary>& flights) {
  std::map<std::string, int> outcomes;
  for (const FlightSummary& s : flights) ++outcomes[outcome_name(s.score.outcome)];
  for (const auto& [outcome, count] : outcomes) fmt::print(out, "{:<26}{:8}\n", outcome, count);
  fmt::print(out, "\n{:<26}{:>8} {:>8} {:>8}\n", "in truth", "median", "95 %", "largest");
  print_quantiles(out, "tracking error, rms", "m", flights,
                  [](const FlightSummary& s) { return s.tracking.rms(); });
  print_quantiles(out, "worst waypoint", "m", flights, [](const FlightSummary& s) {
    double worst = 0.0;
    for (const auto& pass : s.score.waypoints) worst = std::fmax(worst, pass.truth_distance_m);
    return worst;
  });
  print_quantiles(out, "touchdown speed", "m/s", flights, [](const FlightSummary& s) {
    const auto& t = s.score.landing.touchdown();
    return t ? t->speed_m_s : flight::ErrorStatistics::kNone;
  });
  print_quantiles(out, "touchdown from the aim", "m", flights, [](const FlightSummary& s) {
    return s.score.landing.distance_m(s.score.limits);
  });
}

void print_failures(std::ostream& out, const std::vector<FlightSummary>& flights) {
  constexpr int kMaxShown = 20;
  int failures = 0;
  for (const FlightSummary& s : flights) {
    if (s.score.success() || ++failures > kMaxShown) continue;
    fmt::print(out, "\nseed {}: {}\n  {}\n", s.choice.seed, s.score.verdict,
               command_line(s.choice));
  }
  if (failures > kMaxShown) fmt::print(out, "\nand {} more\n", failures - kMaxShown);
}

}  // namespace

int campaign_command(const flight::FlightChoice& choice, const std::string& seeds,
                     const std::filesystem::path& file, std::ostream& out, std::ostream& err) {
  flight::CampaignOptions options;
  options.choice = choice;
  read_seeds(seeds, options);
  if (std::filesystem::exists(file)) {
    throw config::Error(fmt::format("--out: found {}, allowed a new file", file.string()));
  }
  // Bad input is reported before there is a file, a file that cannot be written before anything flies.
  static_cast<void>(flight::FlightSetup(choice));
  base::write_file(file, flight::campaign_csv({}));
  const std::uint64_t wanted = options.last_seed - options.first_seed + 1;
  const bool terminal = isatty(STDERR_FILENO) == 1;
  options.on_flight = [&err, wanted, terminal](std::size_t done) {
    if (terminal) fmt::print(err, "\r{} of {} flights ", done, wanted);
    if (terminal) err.flush();
  };
  options.interrupted = [] { return base::stop_signal() != 0; };
  const base::SignalWatch watch;
  const auto start = std::chrono::steady_clock::now();
  const std::vector<FlightSummary> flights = fly_campaign(options);
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (terminal) fmt::print(err, "\r{:40}\r", "");
  base::write_file(file, flight::campaign_csv(flights));
  double simulated_s = 0.0;
  bool all = flights.size() == wanted;
  for (const FlightSummary& s : flights) {
    simulated_s += s.sim_time_s;
    all = all && s.score.success();
  }
  fmt::print(out, "{} of {} flights in {:.1f} s, {:.0f} times real time\n\n", flights.size(),
             wanted, wall_s, wall_s > 0.0 ? simulated_s / wall_s : 0.0);
  if (!flights.empty()) print_statistics(out, flights);
  print_failures(out, flights);
  fmt::print(out, "\nrows in {}\n", file.string());
  if (base::stop_signal() != 0) return 128 + base::stop_signal();
  return all ? 0 : 1;
}

}  // namespace rosflight::apps
