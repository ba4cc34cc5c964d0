// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "flight/gazebo/coupling/plugin_options.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight::gazebo {

struct WorldSdf {
  std::string release{
      "fortress"};        ///< fortress, harmonic or jetty: they name their systems differently.
  PluginElements plugin;  ///< With `vehicle`.
};

/// A world of SDF 1.9 that flies in Gazebo: ground, light, Gazebo's physics with the step of the firmware, and the vehicle
/// on its gear at the origin, nose to the north, with the plugin of ros/rosflight_sim/gazebo. Gravity and origin are those of the
/// vehicle file. In mode `dynamics_only` the wrenches set the pace, else the wall clock.
/// @throws config::Error  the plugin would not accept its elements; no such release.
std::string world_sdf(const sim::Vehicle& vehicle, const std::string& name, const WorldSdf& world);

/// "mode=whole_loop" and so on. @throws config::Error  a text without "=".
PluginElements plugin_elements(const std::vector<std::string>& texts);

/// What the plugin is registered as, and its file without lib and .so.
inline constexpr const char* kPluginClass = "rosflight_sim::GazeboPlugin";
inline constexpr const char* kPluginFile = "rosflight_gazebo_plugin";

}  // namespace rosflight::flight::gazebo
