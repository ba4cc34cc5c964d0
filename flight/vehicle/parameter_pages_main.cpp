// SPDX-License-Identifier: BSD-3-Clause
// Writes the pages and default files of all parameters into a source tree: parameter_pages [ROOT]
#include <filesystem>
#include <fstream>
#include <iostream>

#include "flight/vehicle/parameter_pages.hpp"

int main(int argc, char** argv) {
  const std::filesystem::path root = argc > 1 ? argv[1] : ".";
  for (const auto& page : rosflight::flight::parameter_pages()) {
    const auto path = root / page.path;
    std::filesystem::create_directories(path.parent_path());
    if (!(std::ofstream(path, std::ios::binary) << page.text).flush()) {
      std::cerr << "parameter_pages: " << path.string() << " cannot be written\n";
      return 2;
    }
  }
  return 0;
}
