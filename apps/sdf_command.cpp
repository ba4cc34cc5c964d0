// SPDX-License-Identifier: BSD-3-Clause
#include "apps/sdf_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <ostream>

#include "base/atomic_file.hpp"
#include "flight/gazebo/coupling/world_sdf.hpp"
#include "flight/project_root.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/registry.hpp"

namespace rosflight::apps {

namespace {

std::string world(const SdfOptions& options, const std::filesystem::path& file,
                  const sim::Vehicle& vehicle, const std::string& name) {
  flight::gazebo::WorldSdf world;
  world.release = options.world;
  world.plugin = flight::gazebo::plugin_elements(options.plugin);
  world.plugin.emplace_back("vehicle", std::filesystem::absolute(file).string());
  for (const std::string& text : options.overrides)
    world.plugin.emplace_back("set", text.starts_with("vehicle.") ? text.substr(8) : text);
  return flight::gazebo::world_sdf(vehicle, name, world);
}

}  // namespace

int sdf_command(const SdfOptions& options, std::ostream& out) {
  if (!options.output.empty() && !options.force && std::filesystem::exists(options.output))
    throw config::Error(fmt::format("{}: exists; use --force to replace it", options.output));
  sim::Registry registry;
  sim::register_physics(registry);
  registry.add_vehicles(flight::project_root() / "vehicles");
  const sim::Vehicle vehicle = registry.open_vehicle(options.vehicle, options.overrides);
  const std::string name = std::filesystem::path(options.vehicle).stem();
  if (options.world.empty() && !options.plugin.empty())
    throw config::Error("--plugin: found without --world, allowed with it");
  const std::string text =
      options.world.empty() ? flight::vehicle_sdf(vehicle, name)
                            : world(options, registry.vehicle_file(options.vehicle), vehicle, name);
  vehicle.finish();
  if (options.output.empty()) {
    out << text;
  } else {
    base::write_file(options.output, text);
  }
  return 0;
}

}  // namespace rosflight::apps
