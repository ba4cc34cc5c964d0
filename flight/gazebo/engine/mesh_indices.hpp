// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>

namespace rosflight::flight::gazebo {

/// Gazebo's readers of .obj and .dae files take each index of a vertex as it is, and read beyond its list. This looks at
/// the indices first; of other files, and of what is no such file at all, it says nothing.
/// @param where  what the error begins with. @throws std::runtime_error  one line: an index beyond its list.
void check_mesh_indices(const std::filesystem::path& file, const std::string& where);

}  // namespace rosflight::flight::gazebo
