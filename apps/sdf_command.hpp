// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>
#include <vector>

namespace rosflight::apps {

struct SdfOptions {
  std::string vehicle;
  std::string output;  ///< Empty: `out`.
  bool force{false};   ///< Replace a file.
  std::vector<std::string> overrides;
  std::string world;  ///< Release of Gazebo: a world with the plugin; empty: the model alone.
  std::vector<std::string> plugin;  ///< "mode=whole_loop": elements of the plugin, with `world`.
};

/// `./rosflight sdf`: a vehicle as a model of SDF 1.9, flight/vehicle_sdf.hpp, or as a world that flies in Gazebo,
/// flight/gazebo/coupling/world_sdf.hpp.
/// @returns the exit code. @throws config::Error, one line: no such vehicle, the file exists or cannot be
/// written; nothing is written then.
int sdf_command(const SdfOptions& options, std::ostream& out);

}  // namespace rosflight::apps
