// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly/fly_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>

#include "apps/fly/flight_recorder.hpp"
#include "apps/fly/wing_summary.hpp"
#include "apps/report/path_chart.hpp"
#include "apps/report/report.hpp"
#include "companion/parameter_file.hpp"
#include "firmware/boards/qemu_m7/host/emulator.hpp"

namespace rosflight::apps {
namespace {

namespace fs = std::filesystem;

double seconds(sim::Time t) {
  return static_cast<double>(t.count()) * 1e-6;
}

struct Result {
  bool success{};
  std::string verdict;
  double sim_time_s{};
  double flight_time_s{};
  double wall_time_s{};
  std::size_t waypoints_reached{};
  double realtime_factor() const { return wall_time_s > 0.0 ? sim_time_s / wall_time_s : 0.0; }
};

/// The folder of this flight: made, and ours alone. @throws config::Error if it holds something.
fs::path make_folder(const std::optional<fs::path>& wanted) {
  fs::path folder;
  if (wanted) {
    folder = *wanted;
    if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
      throw config::Error(fmt::format(
          "--out: found {} with something in it, allowed a new or empty folder", folder.string()));
    }
  } else {
    int number = 1;
    while (fs::exists(folder = fs::path("flights") / fmt::format("{:04d}", number))) ++number;
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw config::Error(fmt::format("--out: cannot make {}: {}", folder.string(), error.message()));
  }
  return folder;
}

void write_text(const fs::path& file, const std::string& text) {
  const fs::path part = file.string() + ".part";
  std::ofstream stream(part, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw config::Error(fmt::format("{}: cannot be written", part.string()));
  fs::rename(part, file);
}

/// One line on the terminal that keeps up with the flight; whole lines where it is no terminal.
class Progress {
 public:
  Progress(std::ostream& err, bool terminal) : err_{err}, terminal_{terminal} {}

  void note(const DirectorNote& note) {
    const bool chatter = note.source == "fcu" && note.severity == link::Severity::kInfo;
    if (chatter) return;
    clear();
    fmt::print(err_, "{:8.2f} s  {:<9} {}\n", seconds(note.t), note.source, note.text);
  }
  void tick(const Flight& flight) {
    if (!terminal_ || flight.now() < next_) return;
    next_ = flight.now() + std::chrono::seconds(1);
    const sim::Vector3& p = flight.truth().body.p_N;
    fmt::print(err_, "\r{:8.2f} s  {}  north {:.1f} east {:.1f} up {:.1f} m   ",
               seconds(flight.now()), stage_name(flight.director().stage()), p.x(), p.y(), -p.z());
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

Result judge(const Flight& flight, double wall_s) {
  Result result;
  const FlightDirector& director = flight.director();
  result.sim_time_s = seconds(flight.now());
  result.wall_time_s = wall_s;
  if (director.armed_at() > sim::Time{0}) {
    result.flight_time_s = seconds(flight.now() - director.armed_at());
  }
  const auto& arrivals = director.arrivals();
  result.waypoints_reached = static_cast<std::size_t>(
      std::count_if(arrivals.begin(), arrivals.end(), [](const auto& a) { return a.reached; }));
  const std::size_t total = flight.setup().waypoints.size();
  const bool all = result.waypoints_reached == total;
  result.success =
      director.stage() == Stage::kDone && all && flight.autonomy().landed && director.disarmed();
  if (result.success) {
    result.verdict = "All waypoints reached, landed and disarmed.";
  } else if (!director.failure().empty()) {
    result.verdict = fmt::format("Failed: {}.", director.failure());
  } else {
    result.verdict = fmt::format("Failed: {} of {} waypoints reached{}.", result.waypoints_reached,
                                 total, flight.autonomy().landed ? "" : ", not landed");
  }
  return result;
}

void fill_record(report::FlightRecord& record, const Flight& flight, const Result& result,
                 const FlyOptions& options, const FlightRecorder& recorder) {
  const FlightSetup& setup = flight.setup();
  record.vehicle = fs::path(setup.choice.vehicle).stem().string();
  record.mission = fs::path(setup.mission_file).stem().string();
  record.seed = std::to_string(setup.choice.seed);
  record.title = fmt::format("{} flies {}", record.vehicle, record.mission);
  record.success = result.success;
  record.verdict = result.verdict;
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
  if (options.realtime) line += " --realtime";
  record.command_line = line;
  const auto fact = [&record](std::string label, std::string value, std::string unit,
                              bool headline) {
    record.facts.push_back(
        {std::move(label), std::move(value), std::move(unit), headline, report::Tone::kNeutral});
  };
  fact("Waypoints reached",
       fmt::format("{} of {}", result.waypoints_reached, setup.waypoints.size()), "", true);
  const bool wing = flight.wing_record() != nullptr;  // has its own figures
  fact("Tracking error, rms", fmt::format("{:.2f}", flight.tracking().rms_m()), "m", !wing);
  fact("Tracking error, largest", fmt::format("{:.2f}", flight.tracking().max_m), "m", !wing);
  if (!wing && setup.choice.state != "truth") {
    fact("Across ground, less GNSS drift, rms",
         fmt::format("{:.2f}", flight.own_tracking().rms_m()), "m", true);
  }
  if (wing) add_wing_facts(record, *flight.wing_record());
  fact("Flight time", fmt::format("{:.1f}", result.flight_time_s), "s", true);
  fact("Simulated time", fmt::format("{:.1f}", result.sim_time_s), "s", false);
  fact("Warnings", std::to_string(recorder.warnings()), "", false);
  fact("Errors", std::to_string(recorder.errors()), "", false);
  fact("Frames lost by the cable", std::to_string(recorder.dropped_frames()), "", false);
  const auto& arrivals = flight.director().arrivals();
  for (std::size_t k = 0; k < arrivals.size() && k < record.waypoints.size(); ++k) {
    record.waypoints[k].miss_m = arrivals[k].distance_m;
    if (arrivals[k].reached) record.waypoints[k].reached_s = arrivals[k].t_s;
  }
  for (const std::string& text : setup.choice.faults) {
    const sim::Fault fault = sim::parse_fault(text);
    const double to_s = fault.end == sim::Time::max() ? std::numeric_limits<double>::infinity()
                                                      : seconds(fault.end);
    record.faults.push_back({text.substr(0, text.find('@')), seconds(fault.start), to_s});
  }
  for (const companion::NamedValue& entry : setup.firmware) {
    const double standard = firmware_value({}, entry.name);
    if (entry.value.number() == standard) continue;
    record.changed_parameters.push_back(
        {entry.name, fmt::format("{:g}", standard), entry.value.text(), ""});
  }
  record.files = {"flight.mcap",  "summary.json",    "vehicle.yaml",
                  "mission.yaml", "parameters.yaml", "path.svg"};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += fmt::format("\\{}", c);
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += fmt::format("\\u{:04x}", c);
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// Figures of a board with a processor of its own, as further members of the summary.
std::string processor_json(const Flight& flight, double sim_time_s) {
  const auto figures = flight.flight_board().figures();
  if (!figures) return "";
  std::string text = fmt::format(", \"stack_bytes\": {}, \"resets\": {}, \"passes\": {}",
                                 figures->stack_bytes, figures->resets, figures->passes);
  if (figures->instructions > 0) {
    text += fmt::format(", \"instructions\": {}", figures->instructions);
  }
  if (figures->uart_sent > 0) {
    text += fmt::format(
        ", \"uart_sent_bytes_per_s\": {:.0f}, \"uart_received_bytes_per_s\": {:.0f}, "
        "\"uart_lost\": {}",
        static_cast<double>(figures->uart_sent) / sim_time_s,
        static_cast<double>(figures->uart_received) / sim_time_s, figures->uart_lost);
  }
  return text;
}

/// What the firmware counted, and the delay of its gyro filters, as further members of the summary.
std::string firmware_json(const report::FlightRecord& record) {
  std::string text;
  if (std::isfinite(record.gyro.latency_s)) {
    text += fmt::format(", \"gyro_latency_ms\": {:.3f}", 1e3 * record.gyro.latency_s);
  }
  if (!record.counters) return text;
  const link::Counters& c = *record.counters;
  return text + fmt::format(
                    ", \"counters\": {{\"longest_pass_us\": {}, \"pass_budget_us\": {}, "
                    "\"passes_over_budget\": {}, \"passes\": {}, \"frames_dropped\": {}, "
                    "\"tx_dropped\": {}, \"texts_lost\": {}, \"imu_jitter\": [{}], "
                    "\"rejected\": [{}]}}",
                    c.longest_pass_us, c.pass_budget_us, c.passes_over_budget, c.passes,
                    c.frames_dropped, c.tx_dropped, c.texts_lost, fmt::join(c.imu_jitter, ", "),
                    fmt::join(c.rejected, ", "));
}

std::string summary_json(const Flight& flight, const Result& result, FlightRecorder& recorder,
                         const log::LogSummary& log) {
  const FlightSetup& setup = flight.setup();
  std::string waypoints;
  const auto& arrivals = flight.director().arrivals();
  for (std::size_t k = 0; k < setup.waypoints.size(); ++k) {
    const FlightDirector::Arrival arrival =
        k < arrivals.size() ? arrivals[k] : FlightDirector::Arrival{};
    waypoints += fmt::format(
        "{}{{\"reached\": {}, \"distance_m\": {}, \"time_s\": {}}}", k == 0 ? "" : ", ",
        arrival.reached, k < arrivals.size() ? fmt::format("{:.4f}", arrival.distance_m) : "null",
        k < arrivals.size() ? fmt::format("{:.4f}", arrival.t_s) : "null");
  }
  return fmt::format(
      "{{\"success\": {}, \"verdict\": {}, \"board\": {}, \"link\": {}, \"link_protocol\": {}, "
      "\"vehicle\": {}, "
      "\"mission\": {}, \"seed\": {}, "
      "\"sim_time_s\": {:.4f}, \"flight_time_s\": {:.4f}, \"wall_time_s\": {:.4f}, "
      "\"realtime_factor\": {:.1f}, \"waypoints_total\": {}, \"waypoints_reached\": {}, "
      "\"waypoints\": [{}], \"tracking_rms_m\": {:.6f}, \"tracking_max_m\": {:.6f}, "
      "\"own_tracking_rms_m\": {:.6f}, \"own_tracking_max_m\": {:.6f}, {}\"landed\": "
      "{}, "
      "\"disarmed\": {}, \"warnings\": {}, \"errors\": {}, \"frames_dropped\": {}, "
      "\"log\": {}, \"log_sha256\": \"{}\", \"log_messages\": {}, \"log_bytes\": {}{}}}\n",
      result.success, quoted(result.verdict), quoted(setup.choice.board), quoted(setup.choice.link),
      quoted(setup.choice.link_protocol), quoted(setup.choice.vehicle),
      quoted(setup.choice.mission), setup.choice.seed, result.sim_time_s, result.flight_time_s,
      result.wall_time_s, result.realtime_factor(), setup.waypoints.size(),
      result.waypoints_reached, waypoints, flight.tracking().rms_m(), flight.tracking().max_m,
      flight.own_tracking().rms_m(), flight.own_tracking().max_m, wing_json(flight.wing_record()),
      flight.autonomy().landed, flight.director().disarmed(), recorder.warnings(),
      recorder.errors(), recorder.dropped_frames(), quoted(log.path.string()), log.sha256,
      log.messages, log.bytes,
      processor_json(flight, result.sim_time_s) + firmware_json(recorder.record()));
}

void print_summary(std::ostream& out, const Flight& flight, const Result& result,
                   const FlightRecorder& recorder, const fs::path& folder) {
  fmt::print(out, "{}\n\n", result.verdict);
  fmt::print(out, "waypoint  reached  missed by\n");
  const auto& arrivals = flight.director().arrivals();
  for (std::size_t k = 0; k < flight.setup().waypoints.size(); ++k) {
    if (k >= arrivals.size()) {
      fmt::print(out, "{:>8}  not flown\n", k + 1);
    } else if (arrivals[k].reached) {
      fmt::print(out, "{:>8}  {:>5.1f} s  {:.2f} m\n", k + 1, arrivals[k].t_s,
                 arrivals[k].distance_m);
    } else {
      fmt::print(out, "{:>8}  missed   {:.2f} m\n", k + 1, arrivals[k].distance_m);
    }
  }
  fmt::print(out, "\ntracking error   {:.2f} m rms, {:.2f} m largest\n", flight.tracking().rms_m(),
             flight.tracking().max_m);
  if (const WingRecord* wing = flight.wing_record()) print_wing(out, *wing);
  fmt::print(out, "flight time      {:.1f} s of {:.1f} s simulated\n", result.flight_time_s,
             result.sim_time_s);
  fmt::print(out, "speed            {:.0f} times real time ({:.2f} s, log and report included)\n",
             result.realtime_factor(), result.wall_time_s);
  if (const auto figures = flight.flight_board().figures()) {
    fmt::print(out, "processor        {} bytes of stack, {} resets\n", figures->stack_bytes,
               figures->resets);
  }
  fmt::print(out, "faults           {}\n",
             flight.setup().choice.faults.empty()
                 ? "none asked for"
                 : fmt::format("{}", fmt::join(flight.setup().choice.faults, ", ")));
  fmt::print(out, "warnings, errors {}, {}\n", recorder.warnings(), recorder.errors());
  fmt::print(out, "flight folder    {}  (open report.html)\n", folder.string());
}

}  // namespace

int fly_command(const FlyOptions& options, std::ostream& out, std::ostream& err) {
  const auto start = std::chrono::steady_clock::now();
  const auto setup = std::make_unique<FlightSetup>(options.choice);
  const auto flight =
      std::make_unique<Flight>(*setup, options.guide ? options.guide(*setup) : nullptr);
  const fs::path folder = make_folder(options.out);
  FlightRecorder recorder(*flight, folder / "flight.mcap");
  Progress progress(err, isatty(STDERR_FILENO) == 1);
  flight->director().set_notify([&recorder, &progress](const DirectorNote& note) {
    recorder.note(note);
    progress.note(note);
  });
  sim::SteadyWallClock wall;
  sim::PacedTime pace(Flight::kStep, 1.0, wall);
  if (options.realtime || options.choice.link == "uart") flight->set_pace(pace);
  try {
    while (!flight->director().finished()) {
      flight->step();
      progress.tick(*flight);
    }
  } catch (const boards::m7::EmulatorError& error) {
    progress.clear();
    fmt::print(err, "rosflight: {:.2f} s: {}\n", seconds(flight->now()), error.what());
    return 1;
  }
  progress.clear();

  const log::LogSummary log = recorder.close();
  const auto elapsed = [&start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Result result = judge(*flight, elapsed());
  fill_record(recorder.record(), *flight, result, options, recorder);
  report::write_report(recorder.record(), folder / "report.html");
  write_text(folder / "path.svg", report::path_svg(recorder.record()));
  write_text(folder / "vehicle.yaml", setup->vehicle.text());
  write_text(folder / "mission.yaml", setup->mission_text);
  companion::write_parameter_file(folder / "parameters.yaml",
                                  flight->session().parameters().table().values(),
                                  flight->session().firmware_version());
  result.wall_time_s = elapsed();
  const std::string json = summary_json(*flight, result, recorder, log);
  write_text(folder / "summary.json", json);
  if (options.json) {
    out << json;
  } else {
    print_summary(out, *flight, result, recorder, folder);
  }
  return result.success ? 0 : 1;
}

}  // namespace rosflight::apps
