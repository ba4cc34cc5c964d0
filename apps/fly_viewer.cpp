// SPDX-License-Identifier: BSD-3-Clause
#include "apps/fly_viewer.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <ostream>
#include <utility>
#include <vector>

#include "base/stop_signal.hpp"
#include "viewer/holoocean/package.hpp"
#include "viewer/holoocean/scenario.hpp"

namespace rosflight::apps {
namespace {

namespace holoocean = viewer::holoocean;

holoocean::Scenario scenario_of(const ViewerChoice& choice, const flight::FlyOptions& options) {
  if (choice.scenario) return holoocean::read_scenario_file(*choice.scenario);
  const bool wing = flight::FlightSetup(options.choice).fixed_wing();
  auto scenario = holoocean::default_scenario(wing ? holoocean::AgentType::kFixedWing
                                                   : holoocean::AgentType::kUav);
  // Contacts are counted. Pictures and ranges nobody takes here, so they are not rendered.
  std::erase_if(scenario.sensors, [](const holoocean::SensorSetup& sensor) {
    return sensor.type != holoocean::SensorType::kCollision;
  });
  return scenario;
}

/// Sets the flight up and does not fly it: bad input is found before an engine starts that takes a minute to load.
void check_flight(const flight::FlyOptions& options) {
  if (options.folder) flight::check_flight_folder(*options.folder);
  const auto setup = std::make_unique<flight::FlightSetup>(options.choice);
  const auto trial = std::make_unique<flight::Flight>(
      *setup, options.parts ? options.parts(*setup) : flight::FlightParts{});
}

holoocean::World world_of(const ViewerChoice& choice, const holoocean::Scenario& scenario) {
  if (choice.engine == ViewerChoice::kAttach) return {};
  if (choice.engine.empty()) {
    try {
      return holoocean::find_world(scenario, holoocean::packages_folder());
    } catch (const config::Error& error) {
      throw config::Error(std::string("--viewer: ") + error.what());
    }
  }
  holoocean::World world;
  world.program = choice.engine;
  world.name = scenario.world;
  if (::access(choice.engine.c_str(), X_OK) != 0 || std::filesystem::is_directory(world.program)) {
    throw config::Error("--viewer-engine: found " + choice.engine +
                        ", allowed attach or a program");
  }
  if (world.name.empty()) {
    throw config::Error(
        "--viewer-engine: found a program and no world, allowed with `world` in --viewer-scenario");
  }
  return world;
}

holoocean::Engine::Options engine_options(const ViewerChoice& choice,
                                          const holoocean::Scenario& scenario) {
  holoocean::Engine::Options options;
  options.world = world_of(choice, scenario);
  options.name = choice.name;
  options.window = !choice.offscreen;
  options.interrupted = [] { return base::stop_signal() != 0; };
  if (choice.timeout_s) {
    options.load_timeout = options.tick_timeout =
        std::chrono::milliseconds(static_cast<std::int64_t>(1000.0 * *choice.timeout_s));
  }
  return options;
}

}  // namespace

FlyViewer::FlyViewer(const ViewerChoice& choice, flight::FlyOptions& options, std::ostream& err)
    : err_{err} {
  using holoocean::Visualiser;
  check_flight(options);
  const holoocean::Scenario scenario = scenario_of(choice, options);
  const auto engine = engine_options(choice, scenario);
  holoocean::check_available(engine);
  const bool paced = options.realtime || options.choice.link == "uart";
  const auto note = [&err](const std::string& text) {
    fmt::print(err, "rosflight: --viewer holoocean: {}\n", text);
    err.flush();
  };
  const base::SignalWatch signals;
  visualiser_.emplace(scenario, engine, paced ? Visualiser::Pace::kSkip : Visualiser::Pace::kWait,
                      Visualiser::Receivers{{}, note});
  visualiser_->wait_until_started();
  stop_signal_ = base::stop_signal();
  options.visualisers.push_back(&*visualiser_);
}

FlyViewer::~FlyViewer() {
  if (!visualiser_) return;
  const auto counts = visualiser_->close();
  fmt::print(err_,
             "rosflight: --viewer holoocean: {} ticks, {} pictures, {} states skipped, {} ticks in "
             "contact\n",
             counts.ticks, counts.images, counts.skipped, counts.contacts);
}

}  // namespace rosflight::apps
