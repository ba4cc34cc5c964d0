// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;
constexpr double kNone = ErrorStatistics::kNone;

/// A dash for a value that does not exist.
std::string or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.2f}", value) : "–";
}

void add_fixedwing_facts(report::FlightRecord& record, const FixedWingRecord& w) {
  const auto fact = [&record](const char* label, double value, const char* unit) {
    record.facts.push_back({label, or_dash(value), unit, true, report::Tone::kNeutral});
  };
  fact("Cross-track, straights, rms", w.straight.rms(), "m");
  fact("Cross-track, arcs, rms", w.arc.rms(), "m");
  if (w.corner.count > 0) fact("After sharp corners, rms", w.corner.rms(), "m");
  fact("Height, rms", w.height.rms(), "m");
  fact("Airspeed, rms", w.airspeed.rms(), "m/s");
}

}  // namespace

void add_summary(report::FlightRecord& record, const FlightSetup& setup,
                 const FlightSummary& summary, const FlyOptions& options) {
  record.vehicle = fs::path(setup.choice.vehicle).stem().string();
  record.mission = fs::path(setup.mission_file).stem().string();
  record.seed = std::to_string(setup.choice.seed);
  record.title = fmt::format("{} flies {}", record.vehicle, record.mission);
  const FlightScore& score = summary.score;
  record.success = score.success();
  record.verdict = score.verdict;
  std::string line = command_line(setup.choice);
  if (options.log != FlyOptions{}.log) line += " --log " + options.log;
  if (options.realtime) line += " --realtime";
  record.command_line = line;
  const auto fact = [&record](std::string label, std::string value, std::string unit,
                              bool headline) {
    record.facts.push_back(
        {std::move(label), std::move(value), std::move(unit), headline, report::Tone::kNeutral});
  };
  fact(fmt::format("Waypoints within {:g} m", score.score_radius_m),
       fmt::format("{} of {}", score.waypoints_reached(), score.waypoints.size()), "", true);
  const auto& touchdown = score.landing.touchdown();
  fact("Touchdown speed", or_dash(touchdown ? touchdown->speed_m_s : kNone), "m/s", true);
  fact("Touchdown from aim", or_dash(score.landing.distance_m(score.limits)), "m", true);
  const bool fixedwing = summary.fixedwing.has_value();  // has its own figures
  fact("Tracking error, rms", or_dash(summary.tracking.rms()), "m", !fixedwing);
  fact("Tracking error, largest", or_dash(summary.tracking.largest()), "m", !fixedwing);
  if (!fixedwing && setup.choice.state != "truth") {
    fact("Across ground, less GNSS drift, rms", or_dash(summary.own_tracking.rms()), "m", true);
  }
  if (fixedwing) add_fixedwing_facts(record, *summary.fixedwing);
  fact("Flight time", fmt::format("{:.1f}", summary.flight_time_s), "s", true);
  fact("Simulated time", fmt::format("{:.1f}", summary.sim_time_s), "s", false);
  fact("Warnings", std::to_string(summary.warnings), "", false);
  fact("Errors", std::to_string(summary.errors), "", false);
  fact("Frames lost by the cable", std::to_string(summary.frames_dropped), "", false);
  for (std::size_t k = 0; k < std::min(score.waypoints.size(), record.waypoints.size()); ++k) {
    const WaypointPass& pass = score.waypoints[k];
    record.waypoints[k].truth_m = pass.truth_distance_m;
    record.waypoints[k].estimate_m = pass.estimate_distance_m;
    if (pass.measure != PassMeasure::kPoint) {
      record.waypoints[k].measure =
          pass.measure == PassMeasure::kFlyBy ? "path (fly-by)" : "path (figure)";
    }
    if (pass.within(score.score_radius_m)) record.waypoints[k].reached_s = pass.t_s;
  }
  for (const std::string& text : setup.choice.faults) {
    const sim::Fault fault = sim::parse_fault(text);
    const double to_s = fault.end == sim::Time::max() ? std::numeric_limits<double>::infinity()
                                                      : sim::to_seconds(fault.end);
    record.faults.push_back({text.substr(0, text.find('@')), sim::to_seconds(fault.start), to_s});
  }
  for (const companion::NamedValue& entry : setup.firmware) {
    const double standard = firmware_value({}, entry.name);
    if (entry.value.number() == standard) continue;
    record.changed_parameters.push_back(
        {entry.name, fmt::format("{:g}", standard), entry.value.text(), ""});
  }
  record.files = {"summary.json", "vehicle.yaml", "mission.yaml", "parameters.yaml", "path.svg"};
  if (summary.log) record.files.insert(record.files.begin(), "flight.mcap");
}

}  // namespace rosflight::flight
