// SPDX-License-Identifier: BSD-3-Clause
#include "flight/project_root.hpp"

#include <cstdlib>

#include "config/strict_yaml.hpp"

namespace rosflight::flight {
namespace {

bool holds_data(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_directory(folder / "vehicles", ignored) &&
         std::filesystem::is_directory(folder / "missions", ignored);
}

}  // namespace

std::filesystem::path project_root() {
  if (const char* named = std::getenv("ROSFLIGHT_DATA_DIR")) {
    if (holds_data(named)) return named;
    throw config::Error("ROSFLIGHT_DATA_DIR: found " + std::string(named) +
                        ", allowed a folder with vehicles/ and missions/");
  }
  std::error_code ignored;
  for (std::filesystem::path start :
       {std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path(),
        std::filesystem::current_path(ignored)}) {
    for (; start.has_relative_path(); start = start.parent_path()) {
      for (const auto& folder : {start, start / "share/rosflight"}) {
        if (holds_data(folder)) return folder;
      }
    }
  }
  throw config::Error(
      "project folder: found none above the program, allowed one with vehicles/ and missions/, or "
      "its path in ROSFLIGHT_DATA_DIR");
}

}  // namespace rosflight::flight
