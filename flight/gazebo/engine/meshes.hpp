// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <sdf/sdf.hh>
#include <string>

#include "flight/gazebo/engine/gazebo_libraries.hpp"

namespace rosflight::flight::gazebo {

/// Reads a mesh (.obj, .stl, .dae) as dartsim takes it: triangles with a normal at each vertex. Of a shape with <submesh>
/// it is that part alone.
/// @param where  what errors begin with: the collision.
/// @throws std::runtime_error  one line with the file: Gazebo's reader rejects it or crashes on it, an index is out of
///         range, a number is not finite, a part is not of triangles, no part has that name.
std::unique_ptr<gazebo_common::Mesh> read_mesh(const sdf::Mesh& shape,
                                               const std::filesystem::path& file,
                                               const std::string& where);

}  // namespace rosflight::flight::gazebo
