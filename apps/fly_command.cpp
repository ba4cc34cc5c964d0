// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <unistd.h>

#include <cmath>
#include <iostream>
#include <utility>

#include "base/constants.hpp"
#include "base/stop_signal.hpp"

namespace rosflight::apps {
namespace {

/// Notes of the flight as lines; on a terminal also one line that shows the position.
class Progress {
 public:
  Progress(std::ostream& err, bool terminal) : err_{err}, terminal_{terminal} {}

  void note(const flight::FlightNote& note) {
    const bool chatter = note.source == "fcu" && note.severity == link::Severity::kInfo;
    if (chatter) return;
    clear();
    fmt::print(err_, "{:8.2f} s  {:<9} {}\n", sim::to_seconds(note.t), note.source, note.text);
  }
  void tick(const flight::Flight& flight) {
    if (!terminal_ || flight.now() < next_) return;
    next_ = flight.now() + std::chrono::seconds(1);
    const sim::Vector3& p = flight.truth().body.p_W;
    fmt::print(err_, "\r{:8.2f} s  {}  north {:.1f} east {:.1f} up {:.1f} m   ",
               sim::to_seconds(flight.now()), flight::stage_name(flight.runner().stage()), p.x(),
               p.y(), -p.z());
    err_.flush();
    shown_ = true;
  }
  void clear() {
    if (shown_) fmt::print(err_, "\r{:70}\r", "");
    shown_ = false;
  }

 private:
  std::ostream& err_;
  bool terminal_;
  bool shown_{false};
  sim::Time next_{};
};

/// A dash for a value that does not exist.
std::string or_dash(double value, const char* unit, int digits = 2) {
  return std::isfinite(value) ? fmt::format("{:.{}f} {}", value, digits, unit) : "–";
}

void print_fixedwing(std::ostream& out, const flight::FixedWingRecord& w) {
  fmt::print(out, "cross-track      {} rms on straights, {} on arcs\n",
             or_dash(w.straight.rms(), "m"), or_dash(w.arc.rms(), "m"));
  fmt::print(out, "height, airspeed {}, {} rms\n", or_dash(w.height.rms(), "m"),
             or_dash(w.airspeed.rms(), "m/s"));
}

const char* measured_to(flight::PassMeasure measure) {
  switch (measure) {
    case flight::PassMeasure::kPoint:
      return "";
    case flight::PassMeasure::kFlyBy:
      return "  from the path, fly-by";
    case flight::PassMeasure::kFigure:
      return "  from the path, largest";
  }
  return "";
}

void print_waypoints(std::ostream& out, const flight::FlightScore& score) {
  fmt::print(out, "waypoint     passed     in truth  by the estimate   ({:g} m allowed in truth)\n",
             score.score_radius_m);
  for (std::size_t k = 0; k < score.waypoints.size(); ++k) {
    const flight::WaypointPass& pass = score.waypoints[k];
    const bool flown = std::isfinite(pass.truth_distance_m);
    const std::string when = !flown                              ? "not flown"
                             : pass.within(score.score_radius_m) ? or_dash(pass.t_s, "s", 1)
                                                                 : "missed";
    fmt::print(out, "{:>8}  {:>9}  {:>11}  {:>15}{}\n", k + 1, when,
               or_dash(pass.truth_distance_m, "m"), or_dash(pass.estimate_distance_m, "m"),
               measured_to(pass.measure));
  }
}

/// Where the flight can be looked at.
std::string how_to_see_it(const flight::FlightSummary& s) {
  if (!s.page.empty()) return "(open report.html)";
  if (!s.log) return "(without a log, which report.html is made from)";
  return fmt::format(
      "(./rosflight view {} shows it, and builds the page that later flights leave as report.html)",
      s.folder.string());
}

void print_summary(std::ostream& out, const flight::FlightSummary& s) {
  fmt::print(out, "{}\n\n", s.score.verdict);
  print_waypoints(out, s.score);
  const auto& t = s.score.landing.touchdown();
  fmt::print(
      out, "\ntouchdown        {}\n",
      t ? fmt::format("{:.2f} m/s, {:.1f} m from the aim, tilted by {:.0f} degrees", t->speed_m_s,
                      s.score.landing.distance_m(s.score.limits), t->tilt_rad / base::kRadPerDeg)
        : "–");
  fmt::print(out, "tracking error   {} rms, {} largest, in truth\n", or_dash(s.tracking.rms(), "m"),
             or_dash(s.tracking.largest(), "m"));
  if (s.fixedwing) print_fixedwing(out, *s.fixedwing);
  fmt::print(out, "flight time      {:.1f} s of {:.1f} s simulated\n", s.flight_time_s,
             s.sim_time_s);
  fmt::print(out, "speed            {:.0f} times real time ({:.2f} s, log included)\n",
             s.realtime_factor(), s.wall_time_s);
  if (s.processor) {
    fmt::print(out, "processor        {} bytes of stack, {} resets\n", s.processor->stack_bytes,
               s.processor->resets);
  }
  fmt::print(out, "faults           {}\n",
             s.choice.faults.empty() ? "none asked for"
                                     : fmt::format("{}", fmt::join(s.choice.faults, ", ")));
  fmt::print(out, "warnings, errors {}, {}\n", s.warnings, s.errors);
  fmt::print(out, "flight folder    {}  {}\n", s.folder.string(), how_to_see_it(s));
}

/// The next of a row of flights: FOLDER-2, FOLDER-3, ...
std::filesystem::path folder_after(const std::filesystem::path& first) {
  std::filesystem::path folder = first;
  for (int number = 2; std::filesystem::exists(folder); ++number)
    folder = fmt::format("{}-{}", first.string(), number);
  return folder;
}

flight::FlightSummary fly_once(const flight::FlyOptions& options, bool json, std::ostream& out,
                               std::ostream& err, Progress& progress) {
  flight::FlightSummary summary = flight::fly(options);
  progress.clear();
  for (const std::string& fault : summary.faults_too_late) {
    fmt::print(err, "rosflight: warning: --fault {} did not happen: the flight ended at {:.1f} s\n",
               fault, summary.sim_time_s);
  }
  if (json) {
    out << flight::summary_json(summary);
  } else {
    print_summary(out, summary);
  }
  out.flush();
  return summary;
}

}  // namespace

int fly_command(flight::FlyOptions options, bool json, std::ostream& out, std::ostream& err,
                viewer::FlightWatch* watch, std::string* log_sha256) {
  Progress progress(err, isatty(STDERR_FILENO) == 1);
  options.on_note = [&progress](const flight::FlightNote& note) { progress.note(note); };
  options.on_step = [&progress](const flight::Flight& flight) { progress.tick(flight); };
  options.interrupted = [] { return base::stop_signal() != 0; };
  if (watch != nullptr) {
    options.observer = &watch->observer();
    options.commander = &watch->commander();
  }
  const base::SignalWatch signals;
  const auto first = options.folder;
  try {
    for (;;) {
      const flight::FlightSummary summary = fly_once(options, json, out, err, progress);
      if (log_sha256 != nullptr && summary.log) *log_sha256 = summary.log->sha256;
      const int code = summary.score.success() ? 0 : 1;
      if (base::stop_signal() != 0) return 128 + base::stop_signal();
      const auto mission = watch != nullptr ? watch->stay(summary) : std::nullopt;
      if (!mission) return code;
      if (!mission->empty()) options.choice.mission = *mission;
      if (first) options.folder = folder_after(*first);
    }
  } catch (const flight::FlightAborted& error) {
    progress.clear();
    fmt::print(err, "rosflight: {}\n", error.what());
    return 1;
  }
}

}  // namespace rosflight::apps
