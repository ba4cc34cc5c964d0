// SPDX-License-Identifier: BSD-3-Clause
#include "sim/vehicle.hpp"

#include <string>

namespace rosflight::sim {
namespace {

constexpr int kMaxChain = 8;

namespace fs = std::filesystem;

/// Beside the file that extends it, or else among the vehicles of the project.
fs::path find_base(const config::Section& root, const fs::path& library) {
  fs::path name = root.text("extends");
  if (name.extension().empty()) name += ".yaml";
  const fs::path beside = root.directory() / name;
  return fs::exists(beside) || library.empty() || !fs::exists(library / name) ? beside
                                                                              : library / name;
}

/// The file on top of all that it extends.
config::Document read_chain(const fs::path& file, const fs::path& library, int depth) {
  config::Document document = config::Document::from_file(file);
  const config::Section root = document.root();
  if (!root.has("extends")) return document;
  if (depth == kMaxChain) {
    throw root.error("extends", "a chain of more than " + std::to_string(kMaxChain) + " files",
                     "a shorter one");
  }
  config::Document base = read_chain(find_base(root, library), library, depth + 1);
  base.merge(document);
  return base;
}

/// A section that text() does not show where the file has none.
config::Section section_or_empty(const config::Section& root, const char* key) {
  if (root.has(key)) return root.foreign_section(key);
  return config::Document::from_text("{}", key).root();
}

}  // namespace

Vehicle Vehicle::from_file(const std::filesystem::path& file,
                           const std::vector<std::string>& overrides,
                           const std::filesystem::path& library) {
  config::Document document = read_chain(file, library, 0);
  document.remove("extends");  // done
  for (const auto& assignment : overrides) document.set(assignment);
  return Vehicle(std::move(document));
}

Vehicle::Vehicle(config::Document document)
    : document_{std::move(document)},
      root_{document_.root()},
      type_{root_.text("type")},
      body_{read_body(root_.section("body"))},
      ground_{read_ground(root_.section("ground"))},
      environment_{read_environment(root_.section("environment"))},
      sensors_{root_.foreign_section("sensors")},
      world_sensors_{section_or_empty(root_, "world_sensors")},
      firmware_{root_.foreign_section("firmware")},
      autonomy_{root_.foreign_section("autonomy")} {
  for (Vector3& contact : ground_.contacts_B) contact -= body_.centre_of_mass_B;
}

void Vehicle::drop_file() {
  document_ = config::Document::from_text("{}", "a file that was dropped");
  root_ = sensors_ = world_sensors_ = firmware_ = autonomy_ = document_.root();
}

}  // namespace rosflight::sim
