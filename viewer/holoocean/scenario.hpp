// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/strict_yaml.hpp"

namespace rosflight::viewer::holoocean {

/// Sensors of the engine that the adapter reads.
enum class SensorType {
  kLocation,
  kRotation,
  kVelocity,
  kCollision,
  kRangeFinder,
  kRgbCamera,
  kDepthCamera,
  kSegmentationCamera,
};

/// The engine's name of the type, as in a scenario file.
const char* engine_name(SensorType type);
bool is_camera(SensorType type);

/// One sensor of the agent. Lengths and angles are the engine's: x forward, y left, z up; roll, pitch, yaw about
/// fixed axes.
struct SensorSetup {
  SensorType type{};
  std::string name;
  std::string socket;  ///< Empty: the root of the agent.
  std::array<double, 3> location_m{};
  std::array<double, 3> rotation_deg{};
  int ticks_per_sample{1};
  int width_px{};   ///< Cameras only, like the next.
  int height_px{};  ///< A pixel has 4 bytes.
  int rays{};  ///< Range finder only, like the next two. Evenly over 360 degrees, the first forward.
  double max_range_m{};       ///< A ray that hits nothing within it has no range.
  double elevation_deg{};     ///< Angle of the rays above the horizon of the sensor; -90 is down.
  std::string configuration;  ///< JSON text for the engine.

  /// Size of its shared memory block.
  std::size_t bytes() const;
};

/// The two bodies of the engine that fly.
enum class AgentType { kUav, kFixedWing };

/// A scenario of HoloOcean with one aircraft, read and checked.
struct Scenario {
  std::string name;
  std::string package;  ///< Folder of the installed worlds.
  std::string world;    ///< Empty: the one named default, else the first one of the package.
  AgentType agent_type{AgentType::kUav};
  std::string agent;  ///< Its name.
  int control_scheme{};
  /// Position in the level of the origin of our frame W. North is x of the level.
  std::array<double, 3> location_m{};
  std::array<double, 3> rotation_deg{};  ///< Attitude until the first state is sent.
  std::vector<SensorSetup> sensors;
  int ticks_per_s{30};
  int frames_per_s{30};  ///< Upper limit per second of wall time; 0: none.
  int window_width_px{1280};
  int window_height_px{720};
  /// Box and cell sizes of the engine's map of obstacles, for its sonars; nothing: those of the world.
  std::optional<std::array<double, 3>> env_min_m, env_max_m;
  std::optional<double> octree_min_m, octree_max_m;
};

/// Reads a scenario file (JSON). Every key must be known and of the right type; `Hz` of a sensor must divide
/// ticks_per_sec; no name may occur twice.
/// @throws config::Error  FILE:LINE: KEY: found X, allowed Y
Scenario read_scenario(const config::Document& document);
Scenario read_scenario_file(const std::filesystem::path& file);

/// The scenario without a file: package Land, an RGB camera of 512 x 512 pixels that looks forward, six rays
/// around the vehicle and one down, each 30 times a second.
Scenario default_scenario(AgentType agent);

}  // namespace rosflight::viewer::holoocean
