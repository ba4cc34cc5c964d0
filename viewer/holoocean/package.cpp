// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/package.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <vector>

namespace rosflight::viewer::holoocean {
namespace {

namespace fs = std::filesystem;
using config::Range;
using config::Section;

constexpr int kMaxSteps = 100'000;
constexpr const char* kDefaultWorld = "default";  // a world of package Land has this name

/// "2.10.0" is newer than "2.9.1".
std::vector<int> version_of(const fs::path& folder) {
  std::vector<int> numbers;
  const std::string text = folder.filename().string();
  for (const char c : text) {
    const bool digit = c >= '0' && c <= '9';
    if (numbers.empty() || !digit) numbers.push_back(0);
    if (digit) numbers.back() = std::min(numbers.back() * 10 + (c - '0'), kMaxSteps);
  }
  return numbers;
}

/// The package of the newest version that has it; empty: none has.
fs::path newest(const fs::path& folder, const std::string& package) {
  std::vector<fs::path> versions;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (fs::exists(entry.path() / "worlds" / package / "config.json", ignored)) {
      versions.push_back(entry.path());
    }
  }
  if (versions.empty()) return {};
  return *std::max_element(
             versions.begin(), versions.end(),
             [](const fs::path& a, const fs::path& b) { return version_of(a) < version_of(b); }) /
         "worlds" / package;
}

std::optional<std::array<double, 3>> corner(const Section& world, std::string_view key) {
  if (!world.has(key)) return std::nullopt;
  const auto values = world.numbers(key, 3, Range::any());
  return std::array<double, 3>{values[0], values[1], values[2]};
}

/// Keys of others are allowed: the file belongs to the package.
World world_of(const Section& config, const std::string& wanted, const std::string& package) {
  std::vector<World> worlds;
  std::vector<std::string> names;
  for (const Section& entry : config.sections("worlds")) {
    World world;
    world.name = entry.text("name");
    world.pre_start_steps =
        static_cast<int>(entry.integer("pre_start_steps", 0, kMaxSteps, world.pre_start_steps));
    world.env_min_m = corner(entry, "env_min");
    world.env_max_m = corner(entry, "env_max");
    names.push_back(world.name);
    worlds.push_back(std::move(world));
  }
  const auto found = std::find(names.begin(), names.end(), wanted.empty() ? kDefaultWorld : wanted);
  if (found != names.end()) return worlds[static_cast<std::size_t>(found - names.begin())];
  if (wanted.empty() && !worlds.empty()) return worlds.front();
  throw config::Error(fmt::format("world: found {}, allowed {}, the worlds of package {}",
                                  wanted.empty() ? "none" : wanted, fmt::join(names, ", "),
                                  package));
}

}  // namespace

fs::path packages_folder() {
  if (const char* path = std::getenv("HOLODECKPATH"); path != nullptr) return path;
  const char* const home = std::getenv("HOME");
  return fs::path(home != nullptr ? home : "/") / ".local/share/holoocean";
}

World find_world(const Scenario& scenario, const fs::path& folder) {
  const fs::path package = newest(folder, scenario.package);
  if (package.empty()) {
    throw config::Error(
        fmt::format("found no HoloOcean package {0} in {1}/VERSION/worlds; to install it, link "
                    "your GitHub account to Epic Games, clone "
                    "https://github.com/byu-holoocean/HoloOcean, in its folder client run "
                    "python3 -m venv .venv && .venv/bin/pip install . && .venv/bin/python -c "
                    "'import holoocean; holoocean.install(\"{0}\")'",
                    scenario.package, folder.string()));
  }
  const auto document = config::Document::from_file(package / "config.json");
  const Section config = document.root();
  World world = world_of(config, scenario.world, scenario.package);
  world.program = package / config.text("path");
  if (::access(world.program.c_str(), X_OK) != 0) {
    throw config.error("path", world.program.string(),
                       "the path of a program below " + package.string());
  }
  return world;
}

}  // namespace rosflight::viewer::holoocean
