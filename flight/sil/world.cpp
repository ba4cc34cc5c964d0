// SPDX-License-Identifier: BSD-3-Clause
#include "flight/sil/world.hpp"

#include <fmt/format.h>

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

sim::rc::Script read_rc(const SilOptions& options) {
  if (!options.rc) return {};
  const auto document = config::Document::from_file(*options.rc);
  return sim::rc::read_script(document.root());
}

/// This process is the processor: it cannot break down and start again.
sim::FaultSchedule read_faults(const SilOptions& options) {
  sim::FaultSchedule faults = sim::parse_faults(options.faults);
  for (const sim::Fault& fault : faults.faults()) {
    if (fault.kind == sim::FaultKind::kCrash || fault.kind == sim::FaultKind::kHang) {
      throw config::Error("--fault: found crash or hang, allowed with ./rosflight fly only");
    }
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
      pilot_{read_rc(options)} {}

void SilWorld::before_step(sim::Time t) {
  for (std::size_t k = 0; k < sim::kMaxRotors; ++k) {
    forces_->set_thrust_factor(k, faults_.thrust_factor(k, t));
  }
}

}  // namespace rosflight::flight
