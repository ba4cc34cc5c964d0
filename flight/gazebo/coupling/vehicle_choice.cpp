// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/vehicle_choice.hpp"

#include "flight/project_root.hpp"

namespace rosflight::flight::gazebo {

sim::Vehicle open_vehicle(const FlightChoice& choice) {
  sim::Registry registry;
  sim::register_physics(registry);
  const std::string& name = choice.vehicle;
  if (name.find('/') == std::string::npos && !name.ends_with(".yaml"))
    registry.add_vehicles(project_root() / "vehicles");
  return registry.open_vehicle(name, choice.overrides);
}

}  // namespace rosflight::flight::gazebo
