// SPDX-License-Identifier: BSD-3-Clause
#include "flight/fly.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "base/atomic_file.hpp"
#include "companion/parameter_file.hpp"
#include "firmware/boards/common/host/child_process.hpp"
#include "flight/flight_page.hpp"
#include "flight/flight_recorder.hpp"
#include "flight/preflight_json.hpp"
#include "flight/repeat.hpp"
#include "sim/time_sources.hpp"

namespace rosflight::flight {
namespace {

namespace fs = std::filesystem;

LogLevel log_level(const std::string& name) {
  if (name == "none") return LogLevel::kNone;
  return name == "full" ? LogLevel::kFull : LogLevel::kPlot;
}

/// The page is made of the log, so a flight without one has none.
std::unique_ptr<FlightPage> page_for(const FlyOptions& options, const FlightSetup& setup,
                                     const fs::path& folder) {
  const fs::path built = FlightPage::built();
  if (built.empty() || options.log == "none") return nullptr;
  return std::make_unique<FlightPage>(built, folder, log_facts(setup));
}

std::vector<log::LogObserver*> observers(const FlyOptions& options, FlightPage* page) {
  std::vector<log::LogObserver*> all;
  if (options.observer != nullptr) all.push_back(options.observer);
  if (page != nullptr) all.push_back(&page->observer());
  return all;
}

/// @returns whether it was interrupted.
bool run(Flight& flight, const FlyOptions& options) {
  try {
    while (!flight.finished()) {
      if (options.interrupted && options.interrupted()) return true;
      if (options.commander != nullptr && options.commander->ends(flight.now())) return true;
      flight.step();
      if (options.on_step) options.on_step(flight);
    }
  } catch (const boards::EmulatorError& error) {
    throw FlightAborted(fmt::format("{:.2f} s: {}", sim::to_seconds(flight.now()), error.what()));
  }
  return false;
}

/// All of a flight folder but log, page and summary.
void write_files(const fs::path& folder, Flight& flight, const std::string& analysis) {
  const FlightSetup& setup = flight.setup();
  base::write_file(folder / "analysis.json", analysis);
  base::write_file(folder / "preflight.json", preflight_json(flight.runner().checks()));
  base::write_file(folder / "vehicle.yaml", setup.vehicle.text());
  base::write_file(folder / "mission.yaml", setup.mission_text);
  if (!setup.choice.world.empty())
    base::write_file(folder / "world.sdf", read_text(setup.choice.world));
  companion::write_parameter_file(folder / "parameters.yaml",
                                  flight.session().parameters().table().values(),
                                  flight.session().firmware_version());
}

}  // namespace

void check_flight_folder(const fs::path& folder) {
  if (fs::exists(folder) && (!fs::is_directory(folder) || !fs::is_empty(folder))) {
    throw config::Error(fmt::format(
        "--out: found {} with something in it, allowed a new or empty folder", folder.string()));
  }
}

fs::path make_flight_folder(const std::optional<fs::path>& wanted) {
  fs::path folder;
  if (wanted) {
    folder = *wanted;
    check_flight_folder(folder);
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

FlightSummary fly(const FlyOptions& options) {
  if (!options.leave_folder && (options.log != "none" || options.folder)) {
    throw config::Error("--log: found " + options.log + " without a flight folder, allowed none");
  }
  const auto start = std::chrono::steady_clock::now();
  const auto setup = std::make_unique<FlightSetup>(options.choice);
  FlightParts parts = options.parts ? options.parts(*setup) : FlightParts{};
  sim::SteadyWallClock wall;
  sim::PacedTime pace(Flight::kStep, options.speed, wall);
  const bool paced = options.realtime || options.choice.link == "uart";
  if (paced && parts.time == nullptr) parts.time = &pace;
  const sim::TimeSource* const parts_time = parts.time;
  const auto flight = std::make_unique<Flight>(*setup, std::move(parts));
  for (sim::Visualiser* const visualiser : options.visualisers) flight->add(*visualiser);
  const fs::path folder = options.leave_folder ? make_flight_folder(options.folder) : fs::path{};
  const std::unique_ptr<FlightPage> page = page_for(options, *setup, folder);
  FlightRecorder recorder(*flight, folder / "flight.mcap", log_level(options.log),
                          observers(options, page.get()));
  const MissionRunner::Notify notify = [&recorder, &options](const FlightNote& note) {
    recorder.note(note);
    if (options.on_note) options.on_note(note);
  };
  flight->runner().set_notify(notify);
  if (options.commander != nullptr) {
    options.commander->begin(parts_time == &pace ? &pace : nullptr);
    flight->set_script([&options, &notify](Flight& flying, sim::Time t) {
      options.commander->step(flying, t, notify);
    });
  }
  const bool interrupted = run(*flight, options);
  if (interrupted) notify({flight->now(), kOperator, link::Severity::kInfo, "ends the flight"});
  if (options.commander != nullptr) options.commander->end();

  std::optional<log::LogSummary> log = recorder.close();
  FlightSummary summary = summarise(*flight, interrupted);
  summary.folder = folder;
  summary.arguments = options.arguments;
  summary.log = std::move(log);
  summary.warnings = recorder.warnings();
  summary.errors = recorder.errors();
  summary.frames_dropped = recorder.dropped_frames();
  summary.gyro_latency_s = recorder.analysis().gyro.latency_s;
  summary.counters = recorder.counters();
  std::string analysis;
  if (options.leave_folder) {
    analysis = analysis_json(*setup, recorder.analysis());
    write_files(folder, *flight, analysis);
  }
  summary.wall_time_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!options.leave_folder) return summary;
  const std::string text = summary_json(summary);
  base::write_file(folder / "summary.json", text);
  if (page) {
    page->write(text, analysis);
    summary.page = folder / "report.html";
  }
  return summary;
}

}  // namespace rosflight::flight
