// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "sim/environment/environment.hpp"
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// What the instruments are made from.
struct SensorSettings {
  sim::sensors::SensorsConfig sensors;
  sim::EnvironmentParameters environment;
};

/// A parameter of ROSflight 2.x's sensors node as a view of our settings: value in its unit and
/// law, whatever ours are (sim/noise.hpp). get(set(x)) is x.
struct SensorParameter {
  std::string name;
  double least;
  double most;
  std::string text;
  std::function<double(const SensorSettings&)> get;
  std::function<void(SensorSettings&, double)> set;
};

/// Rates come first: laws per sample depend on them.
std::vector<SensorParameter> sensor_parameters();

}  // namespace rosflight_sim
