// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <unistd.h>

#include <iostream>
#include <utility>

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

void print_fixedwing(std::ostream& out, const flight::FixedWingRecord& w) {
  fmt::print(out, "cross-track      {:.2f} m rms on straights, {:.2f} m on arcs\n",
             w.straight.rms(), w.arc.rms());
  fmt::print(out, "height, airspeed {:.2f} m, {:.2f} m/s rms\n", w.height.rms(), w.airspeed.rms());
  if (const auto& t = w.touchdown()) {
    fmt::print(out, "touch-down       {:.1f} m from the aim point, sink {:.2f} m/s\n",
               t->distance_m, t->sink_m_s);
  }
}

void print_summary(std::ostream& out, const flight::FlightSummary& s) {
  fmt::print(out, "{}\n\n", s.verdict);
  fmt::print(out, "waypoint  reached  missed by\n");
  for (std::size_t k = 0; k < s.waypoints_total; ++k) {
    if (k >= s.arrivals.size()) {
      fmt::print(out, "{:>8}  not flown\n", k + 1);
    } else if (s.arrivals[k].reached) {
      fmt::print(out, "{:>8}  {:>5.1f} s  {:.2f} m\n", k + 1, s.arrivals[k].t_s,
                 s.arrivals[k].distance_m);
    } else {
      fmt::print(out, "{:>8}  missed   {:.2f} m\n", k + 1, s.arrivals[k].distance_m);
    }
  }
  fmt::print(out, "\ntracking error   {:.2f} m rms, {:.2f} m largest\n", s.tracking.rms(),
             s.tracking.max);
  if (s.fixedwing) print_fixedwing(out, *s.fixedwing);
  fmt::print(out, "flight time      {:.1f} s of {:.1f} s simulated\n", s.flight_time_s,
             s.sim_time_s);
  fmt::print(out, "speed            {:.0f} times real time ({:.2f} s, log and report included)\n",
             s.realtime_factor(), s.wall_time_s);
  if (s.processor) {
    fmt::print(out, "processor        {} bytes of stack, {} resets\n", s.processor->stack_bytes,
               s.processor->resets);
  }
  fmt::print(out, "faults           {}\n",
             s.choice.faults.empty() ? "none asked for"
                                     : fmt::format("{}", fmt::join(s.choice.faults, ", ")));
  fmt::print(out, "warnings, errors {}, {}\n", s.warnings, s.errors);
  fmt::print(out, "flight folder    {}  (open report.html)\n", s.folder.string());
}

}  // namespace

int fly_command(flight::FlyOptions options, bool json, std::ostream& out, std::ostream& err) {
  Progress progress(err, isatty(STDERR_FILENO) == 1);
  options.on_note = [&progress](const flight::FlightNote& note) { progress.note(note); };
  options.on_step = [&progress](const flight::Flight& flight) { progress.tick(flight); };
  try {
    const flight::FlightSummary summary = flight::fly(options);
    progress.clear();
    if (json) {
      out << flight::summary_json(summary);
    } else {
      print_summary(out, summary);
    }
    return summary.success ? 0 : 1;
  } catch (const flight::FlightAborted& error) {
    progress.clear();
    fmt::print(err, "rosflight: {}\n", error.what());
    return 1;
  }
}

}  // namespace rosflight::apps
