// SPDX-License-Identifier: BSD-3-Clause
// Prints a world file for Gazebo, as `./rosflight sdf --world` writes it: for the launch files.
//
// usage: gazebo_world RELEASE NAME=VALUE...    vehicle=FILE and other elements of the plugin
#include <cstdio>
#include <exception>
#include <filesystem>

#include "flight/gazebo/coupling/vehicle_choice.hpp"
#include "flight/gazebo/coupling/world_sdf.hpp"

int main(int argc, char** argv) {
  namespace gazebo = rosflight::flight::gazebo;
  if (argc < 3) {
    std::fprintf(stderr, "usage: gazebo_world RELEASE NAME=VALUE...\n");
    return 2;
  }
  try {
    gazebo::WorldSdf world;
    world.release = argv[1];
    for (auto& [name, value] : gazebo::plugin_elements({argv + 2, argv + argc}))
      if (!value.empty()) world.plugin.emplace_back(name, value);
    const gazebo::PluginOptions options = gazebo::read_plugin_options(world.plugin);
    const std::string name = std::filesystem::path(options.choice.vehicle).stem();
    const std::string text = gazebo::world_sdf(gazebo::open_vehicle(options.choice), name, world);
    std::fputs(text.c_str(), stdout);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gazebo_world: %s\n", error.what());
    return 2;
  }
  return 0;
}
