// SPDX-License-Identifier: BSD-3-Clause
#include "apps/project_root.hpp"

#include "config/strict_yaml.hpp"

namespace rosflight::apps {

std::filesystem::path project_root() {
  std::error_code ignored;
  for (std::filesystem::path start :
       {std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path(),
        std::filesystem::current_path(ignored)}) {
    for (; start.has_relative_path(); start = start.parent_path()) {
      if (std::filesystem::is_directory(start / "vehicles", ignored) &&
          std::filesystem::is_directory(start / "missions", ignored)) {
        return start;
      }
    }
  }
  throw config::Error(
      "project folder: found none above the program, allowed one with vehicles/ and missions/");
}

}  // namespace rosflight::apps
