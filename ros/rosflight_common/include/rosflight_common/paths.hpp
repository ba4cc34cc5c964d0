// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>

namespace rosflight_common {

/// Path of a file of an installed package, such as "share/rosflight_sim/vehicles/multirotor.yaml": below the first folder of
/// AMENT_PREFIX_PATH that has it.
inline std::optional<std::string> installed(const std::string& file) {
  const char* const known = std::getenv("AMENT_PREFIX_PATH");
  std::istringstream prefixes(known == nullptr ? "" : known);
  for (std::string prefix; std::getline(prefixes, prefix, ':');) {
    const std::filesystem::path path = std::filesystem::path(prefix) / file;
    if (std::filesystem::exists(path)) return path.string();
  }
  return {};
}

/// A path as a user gives it to a service: "~/" is the home folder, for no shell has replaced it.
inline std::string user_path(const std::string& path) {
  const char* const home = std::getenv("HOME");
  if (home == nullptr || path.rfind("~/", 0) != 0) return path;
  return home + path.substr(1);
}

}  // namespace rosflight_common
