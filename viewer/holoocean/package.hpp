// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "viewer/holoocean/scenario.hpp"

namespace rosflight::viewer::holoocean {

/// A world of an installed package.
struct World {
  std::filesystem::path program;  ///< Empty: attach to a running engine.
  std::string name;
  int pre_start_steps{0};
  std::optional<std::array<double, 3>> env_min_m, env_max_m;
};

/// The folder of HoloOcean's packages: the environment variable HOLODECKPATH, else ~/.local/share/holoocean. Below it
/// is a folder for each version of the client.
std::filesystem::path packages_folder();

/// Finds the world of a scenario below `folder`, in the newest version that has its package.
/// @throws config::Error  the package is not installed (says what to install), is damaged or has no such world.
World find_world(const Scenario& scenario, const std::filesystem::path& folder);

}  // namespace rosflight::viewer::holoocean
