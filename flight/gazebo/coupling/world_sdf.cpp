// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/world_sdf.hpp"

#include <fmt/format.h>

#include "base/constants.hpp"
#include "flight/vehicle_sdf.hpp"
#include "sim/dynamics/ground_contact.hpp"

namespace rosflight::flight::gazebo {
namespace {

constexpr const char* kScene =
    "    <light type=\"directional\" name=\"sun\">\n      <cast_shadows>true</cast_shadows>\n"
    "      <pose>0 0 100 0 0 0</pose>\n      <direction>-0.5 0.1 -0.9</direction>\n    </light>\n"
    "    <model name=\"ground\">\n      <static>true</static>\n      <link name=\"link\">\n"
    "        <collision "
    "name=\"plane\"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision>\n"
    "        <visual name=\"plane\"><geometry><plane><normal>0 0 1</normal><size>2000 2000</size>"
    "</plane></geometry><material><diffuse>0.45 0.5 0.4 1</diffuse></material></visual>\n"
    "      </link>\n    </model>\n";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else {
      out += c;
    }
  }
  return out;
}

/// Gazebo's systems that a world must name.
std::string systems(const std::string& release) {
  if (release != "fortress" && release != "harmonic" && release != "jetty")
    throw config::Error(
        fmt::format("release of Gazebo: found {}, allowed fortress, harmonic, jetty", release));
  const bool ignition = release == "fortress";
  std::string out;
  for (const auto& [file, name] : {std::pair{"physics", "Physics"},
                                   {"user-commands", "UserCommands"},
                                   {"scene-broadcaster", "SceneBroadcaster"}}) {
    out += fmt::format("    <plugin filename=\"{}-{}-system\" name=\"{}::systems::{}\"/>\n",
                       ignition ? "ignition-gazebo" : "gz-sim", file,
                       ignition ? "ignition::gazebo" : "gz::sim", name);
  }
  return out;
}

}  // namespace

std::string world_sdf(const sim::Vehicle& vehicle, const std::string& name, const WorldSdf& world) {
  const PluginOptions options = read_plugin_options(world.plugin);
  const sim::EnvironmentParameters environment = vehicle.environment();
  std::string plugin =
      fmt::format("      <plugin filename=\"{}\" name=\"{}\">\n", kPluginFile, kPluginClass);
  for (const auto& [element, text] : world.plugin)
    plugin += fmt::format("        <{0}>{1}</{0}>\n", element, escaped(text));
  const double height_m = sim::GroundContact{vehicle.ground()}.rest_height_m(
      vehicle.body().mass_kg * environment.gravity_m_s2);
  const std::string inside =
      fmt::format("    <pose>0 0 {:.9g} 0 0 {:.17g}</pose>\n{}      </plugin>\n", height_m,
                  0.5 * base::kPi, plugin);
  const bool paced = options.mode == PluginOptions::Mode::kWholeLoop;
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<sdf version=\"1.9\">\n  <world name=\"rosflight\">\n"
      "    <physics name=\"firmware_step\" type=\"ignored\"><max_step_size>{}</max_step_size>"
      "<real_time_factor>{}</real_time_factor></physics>\n    <gravity>0 0 {}</gravity>\n"
      "    <spherical_coordinates><surface_model>EARTH_WGS84</surface_model>"
      "<world_frame_orientation>ENU</world_frame_orientation><latitude_deg>{:.9f}</latitude_deg>"
      "<longitude_deg>{:.9f}</longitude_deg><elevation>{:.3f}</elevation><heading_deg>0</"
      "heading_deg>"
      "</spherical_coordinates>\n{}{}{}  </world>\n</sdf>\n",
      sim::to_seconds(Flight::kStep), paced ? 1 : 0, -environment.gravity_m_s2,
      environment.origin.latitude_deg, environment.origin.longitude_deg,
      environment.origin.altitude_m, systems(world.release), kScene,
      vehicle_model_element(vehicle, name, SdfModel::kWithJoints, inside));
}

PluginElements plugin_elements(const std::vector<std::string>& texts) {
  PluginElements out;
  for (const std::string& text : texts) {
    const std::size_t equal = text.find('=');
    if (equal == std::string::npos || equal == 0)
      throw config::Error(
          fmt::format("element of the plugin: found '{}', allowed NAME=VALUE", text));
    out.emplace_back(text.substr(0, equal), text.substr(equal + 1));
  }
  return out;
}

}  // namespace rosflight::flight::gazebo
