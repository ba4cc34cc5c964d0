// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/world.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>

#include "sim/rc/script.hpp"

namespace rosflight::flight {
namespace {

/// The project's IMU keeps pace with the loop; a module of a user's own keeps its own rates.
sim::Vehicle read_vehicle(const SilOptions& options, sim::Registry& registry, sim::Time step) {
  sim::register_physics(registry);
  sim::sensors::register_sensors(registry);
  for (const auto& plugin : options.plugins) registry.load_plugin(plugin);
  registry.add_vehicles(options.vehicles_folder);
  auto vehicle = registry.open_vehicle(options.vehicle, options.overrides);
  if (vehicle.sensors().text("module", "standard") != "standard") return vehicle;
  std::vector<std::string> overrides = options.overrides;
  overrides.push_back(
      fmt::format("sensors.imu.rate_Hz={:.17g}", 1e6 / static_cast<double>(step.count())));
  return registry.open_vehicle(options.vehicle, std::move(overrides));
}

bool from_input(const SilOptions& options) {
  return options.rc == "-";
}

sim::rc::Script read_rc(const SilOptions& options) {
  if (!options.rc || from_input(options)) return {};
  const auto document = config::Document::from_file(*options.rc);
  return sim::rc::read_script(document.root());
}

/// This process is the processor: it cannot break down and start again. Cable and companion are not
/// in it.
sim::FaultSchedule read_faults(const SilOptions& options) {
  using Kind = sim::FaultKind;
  sim::FaultSchedule faults = sim::parse_faults(options.faults);
  if (faults.has(Kind::kCrash) || faults.has(Kind::kHang)) {
    throw config::Error("--fault: found crash or hang, allowed with ./rosflight fly only");
  }
  if (faults.has(Kind::kLinkNoise) || faults.has(Kind::kCompanionStall)) {
    throw config::Error(
        "--fault: found link_noise or companion_stall, allowed with ./rosflight fly only");
  }
  return faults;
}

}  // namespace

SilWorld::SilWorld(const SilOptions& options, sim::Time step)
    : random_{options.seed},
      faults_{read_faults(options)},
      vehicle_{read_vehicle(options, registry_, step)},
      forces_{registry_.make_forces(vehicle_, random_)},
      dynamics_{vehicle_.body(), vehicle_.ground(), vehicle_.environment(), *forces_, random_},
      sensors_{sim::sensors::make_sensors(registry_, vehicle_, random_)},
      pilot_{read_rc(options)} {
  if (from_input(options)) rc_lines_.emplace(STDIN_FILENO, pilot_, std::cerr);
}

void SilWorld::before_step(sim::Time t) {
  if (rc_lines_) rc_lines_->step();
  sim::apply_actuator_faults(faults_, t, *forces_);
}

}  // namespace rosflight::flight
