// SPDX-License-Identifier: BSD-3-Clause
#include "flight/report_facts.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <string>
#include <utility>

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

void add_fixedwing_facts(report::FlightRecord& record, const FixedWingRecord& w) {
  const auto fact = [&record](const char* label, double value, const char* unit) {
    record.facts.push_back(
        {label, fmt::format("{:.2f}", value), unit, true, report::Tone::kNeutral});
  };
  fact("Cross-track, straights, rms", w.straight.rms(), "m");
  fact("Cross-track, arcs, rms", w.arc.rms(), "m");
  if (w.corner.count > 0) fact("After sharp corners, rms", w.corner.rms(), "m");
  fact("Height, rms", w.height.rms(), "m");
  fact("Airspeed, rms", w.airspeed.rms(), "m/s");
  if (const auto& t = w.touchdown()) {
    fact("Touch-down from aim", t->distance_m, "m");
    fact("Sink at touch-down", t->sink_m_s, "m/s");
  }
}

}  // namespace

void add_summary(report::FlightRecord& record, const FlightSetup& setup,
                 const FlightSummary& summary, const FlyOptions& options) {
  record.vehicle = fs::path(setup.choice.vehicle).stem().string();
  record.mission = fs::path(setup.mission_file).stem().string();
  record.seed = std::to_string(setup.choice.seed);
  record.title = fmt::format("{} flies {}", record.vehicle, record.mission);
  record.success = summary.success;
  record.verdict = summary.verdict;
  std::string line = fmt::format("./rosflight fly --vehicle {} --mission {} --seed {}",
                                 setup.choice.vehicle, setup.choice.mission, setup.choice.seed);
  if (setup.choice.board != "in_process") line += " --board " + setup.choice.board;
  if (setup.choice.link != "cable") line += " --link " + setup.choice.link;
  if (setup.choice.state != FlightChoice{}.state) line += " --state " + setup.choice.state;
  for (const std::string& text : setup.choice.plugins) line += " --plugin " + text;
  if (setup.choice.wind) line += " --wind " + *setup.choice.wind;
  for (const std::string& text : setup.choice.overrides) line += " --set " + text;
  for (const std::string& text : setup.choice.faults) line += " --fault " + text;
  if (setup.choice.link_protocol != FlightChoice{}.link_protocol) {
    line += " --link-protocol " + setup.choice.link_protocol;
  }
  if (options.log != FlyOptions{}.log) line += " --log " + options.log;
  if (options.realtime) line += " --realtime";
  record.command_line = line;
  const auto fact = [&record](std::string label, std::string value, std::string unit,
                              bool headline) {
    record.facts.push_back(
        {std::move(label), std::move(value), std::move(unit), headline, report::Tone::kNeutral});
  };
  fact("Waypoints reached",
       fmt::format("{} of {}", summary.waypoints_reached, summary.waypoints_total), "", true);
  const bool fixedwing = summary.fixedwing.has_value();  // has its own figures
  fact("Tracking error, rms", fmt::format("{:.2f}", summary.tracking.rms()), "m", !fixedwing);
  fact("Tracking error, largest", fmt::format("{:.2f}", summary.tracking.max), "m", !fixedwing);
  if (!fixedwing && setup.choice.state != "truth") {
    fact("Across ground, less GNSS drift, rms", fmt::format("{:.2f}", summary.own_tracking.rms()),
         "m", true);
  }
  if (fixedwing) add_fixedwing_facts(record, *summary.fixedwing);
  fact("Flight time", fmt::format("{:.1f}", summary.flight_time_s), "s", true);
  fact("Simulated time", fmt::format("{:.1f}", summary.sim_time_s), "s", false);
  fact("Warnings", std::to_string(summary.warnings), "", false);
  fact("Errors", std::to_string(summary.errors), "", false);
  fact("Frames lost by the cable", std::to_string(summary.frames_dropped), "", false);
  const auto& arrivals = summary.arrivals;
  for (std::size_t k = 0; k < arrivals.size() && k < record.waypoints.size(); ++k) {
    record.waypoints[k].miss_m = arrivals[k].distance_m;
    if (arrivals[k].reached) record.waypoints[k].reached_s = arrivals[k].t_s;
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
