// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "config/table.hpp"
#include "sim/environment/environment.hpp"
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// What the instruments are made from.
struct SensorSettings {
  sim::sensors::SensorsConfig sensors;
  sim::EnvironmentParameters environment;
};

/// Parameters of ROSflight 2.x's sensors node as views of our settings: values in its units and laws, whatever ours are
/// (sim/noise.hpp). get(set(x)) is x. Rates come first: laws per sample depend on them.
rosflight::config::Table<SensorSettings> sensor_parameters();

/// Rates of ROSflight 2.x's sensors, which estimators written for it expect, as assignments "section.key=value" for a vehicle
/// file: for each sensor whose rate its section `sensors` leaves open. None if that section names a module of its own.
std::vector<std::string> rosflight_rates(const rosflight::config::Section& sensors);

}  // namespace rosflight_sim
