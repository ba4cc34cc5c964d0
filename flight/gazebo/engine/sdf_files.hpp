// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <sdf/sdf.hh>
#include <string>
#include <vector>

/// SDF read as Gazebo would. Every error is one line.
namespace rosflight::flight::gazebo {

inline constexpr const char* kEmptyWorld = "<sdf version='1.9'><world name='empty'/></sdf>";

/// @throws std::runtime_error  the file and the first error in it.
sdf::Root read_sdf(const std::filesystem::path& file);
/// The same of a text. An inertia that no body can have is accepted. @throws std::runtime_error  the first error.
sdf::Root read_sdf_text(const std::string& text);

/// The file that a URI of an SDF file means: `model://NAME/...`, `file://...` and relative paths, from these folders and from
/// those of GZ_SIM_RESOURCE_PATH and IGN_GAZEBO_RESOURCE_PATH. Empty: there is none.
std::string find_file(const std::string& uri, std::vector<std::filesystem::path> folders);

}  // namespace rosflight::flight::gazebo
