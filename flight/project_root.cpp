// SPDX-License-Identifier: BSD-3-Clause
#include "flight/project_root.hpp"

#include <dlfcn.h>

#include <cstdlib>

#include "config/strict_yaml.hpp"

namespace rosflight::flight {
namespace {

bool holds_data(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::is_directory(folder / "vehicles", ignored) &&
         std::filesystem::is_directory(folder / "missions", ignored);
}

/// The file that this code was loaded from: a shared library, such as the Python package, that brings its data along.
/// Empty for a program that was started by a relative path.
std::filesystem::path own_file() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&project_root), &info) == 0 || info.dli_fname == nullptr)
    return {};
  const std::filesystem::path file = info.dli_fname;
  return file.is_absolute() ? file : std::filesystem::path{};
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
       {own_file().parent_path(),
        std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path(),
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
