// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>

#include "sim/world/shapes.hpp"

namespace rosflight::sim::world {

/// Reads the shapes of a world file in SDF, without Gazebo: every `collision` of every static model, which is
/// what Gazebo's physics touches (`--physics gazebo` reads the same file).
///
/// | of SDF | read |
/// |---|---|
/// | geometry | box, cylinder, sphere, plane, mesh (.obj), heightmap (.asc, surface_files.hpp) |
/// | pose | of model, nested model, link and collision: x y z roll pitch yaw, `degrees` too |
/// | files | from the folder of the world file, with or without file:// or model:// |
/// | skipped | what has no surface to meet: light, scene, physics, plugin, visual, inertial, sensor, joint, ... |
///
/// Everything else, such as include, a model that moves, `relative_to` and other geometries, is refused with
/// one line. SDF's axes x east, y north, z up become north, east, down here.
/// @throws config::Error  FILE:LINE: PATH: found X, allowed Y.
WorldShapes read_sdf_world(const std::filesystem::path& file);

}  // namespace rosflight::sim::world
