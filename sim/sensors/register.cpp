// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/register.hpp"

#include <string>

#include "sim/sensors/read_config.hpp"

namespace rosflight::sim::sensors {

void register_sensors(Registry& registry) {
  registry.sensors.add("standard", [](const Vehicle& vehicle, const RandomSource& random) {
    SensorsConfig config = read_sensors(vehicle.sensors());
    const Vector3& centre_B = vehicle.body().centre_of_mass_B;
    config.imu.position_m -= centre_B;
    config.range.position_m -= centre_B;
    config.gnss.position_m -= centre_B;
    return std::make_unique<StandardSensors>(config, vehicle.environment(), random);
  });
}

std::unique_ptr<SensorsModule> make_sensors(const Registry& registry, const Vehicle& vehicle,
                                            const RandomSource& random) {
  const config::Section& section = vehicle.sensors();
  const std::string name = section.text("module", "standard");
  if (!registry.sensors.has(name)) {
    std::string known;
    for (const auto& one : registry.sensors.names()) known += (known.empty() ? "" : ", ") + one;
    throw section.error("module", name, known);
  }
  return registry.sensors.at(name)(vehicle, random);
}

}  // namespace rosflight::sim::sensors
