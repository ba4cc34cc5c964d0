// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/register.hpp"

#include <string>

#include "sim/sensors/exposure.hpp"
#include "sim/sensors/read_config.hpp"

namespace rosflight::sim::sensors {
namespace {

constexpr const char* kStandard = "standard";

/// What the vehicle file wants, with positions from the centre of mass.
SensorsConfig standard_config(const Vehicle& vehicle) {
  SensorsConfig config = read_sensors(vehicle.sensors());
  const Vector3& centre_B = vehicle.body().centre_of_mass_B;
  config.imu.position_m -= centre_B;
  config.range.position_m -= centre_B;
  config.gnss.position_m -= centre_B;
  return config;
}

}  // namespace

void register_sensors(Registry& registry) {
  registry.sensors.add(kStandard, [](const Vehicle& vehicle, const RandomSource& random) {
    return std::make_unique<StandardSensors>(standard_config(vehicle), vehicle.environment(),
                                             random);
  });
}

std::unique_ptr<SensorsModule> make_exposure(const Registry& registry, const Vehicle& vehicle,
                                             const RandomSource& random, Time imu_period,
                                             Time period) {
  if (vehicle.sensors().text("module", kStandard) != kStandard)
    return make_sensors(registry, vehicle, random);
  return std::make_unique<StandardSensors>(exposure(standard_config(vehicle), imu_period, period),
                                           vehicle.environment(), random);
}

std::unique_ptr<SensorsModule> make_sensors(const Registry& registry, const Vehicle& vehicle,
                                            const RandomSource& random) {
  const config::Section& section = vehicle.sensors();
  const std::string name = section.text("module", kStandard);
  if (!registry.sensors.has(name)) {
    std::string known;
    for (const auto& one : registry.sensors.names()) known += (known.empty() ? "" : ", ") + one;
    throw section.error("module", name, known);
  }
  return registry.sensors.at(name)(vehicle, random);
}

}  // namespace rosflight::sim::sensors
