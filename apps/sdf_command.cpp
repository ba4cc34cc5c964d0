// SPDX-License-Identifier: BSD-3-Clause
#include "apps/sdf_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <ostream>

#include "base/atomic_file.hpp"
#include "flight/project_root.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/registry.hpp"

namespace rosflight::apps {

int sdf_command(const SdfOptions& options, std::ostream& out) {
  if (!options.output.empty() && !options.force && std::filesystem::exists(options.output))
    throw config::Error(fmt::format("{}: exists; use --force to replace it", options.output));
  sim::Registry registry;
  sim::register_physics(registry);
  registry.add_vehicles(flight::project_root() / "vehicles");
  const sim::Vehicle vehicle = registry.open_vehicle(options.vehicle, options.overrides);
  const std::string name = std::filesystem::path(options.vehicle).stem();
  const std::string text = flight::vehicle_sdf(vehicle, name);
  vehicle.finish();
  if (options.output.empty()) {
    out << text;
  } else {
    base::write_file(options.output, text);
  }
  return 0;
}

}  // namespace rosflight::apps
