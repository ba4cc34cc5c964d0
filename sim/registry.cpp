// SPDX-License-Identifier: BSD-3-Clause
#include "sim/registry.hpp"

#include <dlfcn.h>

#include <algorithm>

#include "sim/fixedwing/fixedwing.hpp"
#include "sim/multirotor/multirotor.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::sim {
void Registry::load_plugin(const std::filesystem::path& library) {
  const std::string name = library.string();
  // A bare file name would be searched for in the system's folders.
  void* handle = dlopen(std::filesystem::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw config::Error(name + ": found " + (reason == nullptr ? "no library" : reason) +
                        ", allowed a shared library");
  }
  libraries_.emplace_back(handle, [](void* open) { dlclose(open); });
  void* symbol = dlsym(handle, "rosflight_register");
  if (symbol == nullptr)
    throw config::Error(name + ": found no function rosflight_register, allowed a plugin");
  // POSIX guarantees that a function fits a void pointer.
  const auto enrol = reinterpret_cast<void (*)(Registry&)>(symbol);
  enrol(*this);
}

void Registry::add_vehicles(const std::filesystem::path& folder) {
  std::error_code code;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  if (code)
    throw config::Error(folder.string() + ": found no such folder, allowed one with vehicle files");
  std::sort(files.begin(), files.end());
  for (const auto& file : files) vehicles.add(file.stem().string(), file);
  vehicles_folder_ = folder;
}

std::filesystem::path Registry::vehicle_file(const std::string& name_or_path) const {
  if (vehicles.has(name_or_path)) return vehicles.at(name_or_path);
  std::filesystem::path path(name_or_path);
  if (path.extension() == ".yaml" || name_or_path.find('/') != std::string::npos) return path;
  return vehicles.at(name_or_path);
}

Vehicle Registry::open_vehicle(const std::string& name_or_path,
                               std::vector<std::string> overrides) const {
  for (std::string& text : overrides) {
    constexpr std::string_view kPrefix = "vehicle.";
    if (text.starts_with(kPrefix)) text.erase(0, kPrefix.size());
  }
  return Vehicle::from_file(vehicle_file(name_or_path), overrides, vehicles_folder_);
}

std::unique_ptr<ForcesAndMoments> Registry::make_forces(const Vehicle& vehicle,
                                                        const RandomSource& random) const {
  if (!forces.has(vehicle.type())) {
    std::string known;
    for (const auto& name : forces.names()) known += (known.empty() ? "" : ", ") + name;
    throw vehicle.root().error("type", vehicle.type(), known);
  }
  auto module = forces.at(vehicle.type())(vehicle, random);
  vehicle.finish();
  return module;
}

void register_physics(Registry& registry) {
  registry.forces.add("fixedwing", [](const Vehicle& vehicle, const RandomSource&) {
    return std::make_unique<FixedWing>(read_fixed_wing(vehicle.root()));
  });
  registry.forces.add("multirotor", [](const Vehicle& vehicle, const RandomSource&) {
    return std::make_unique<Multirotor>(read_multirotor(vehicle.root()));
  });
  registry.forces.add("quadplane", [](const Vehicle& vehicle, const RandomSource&) {
    return std::make_unique<FixedWing>(read_quadplane(vehicle.root()));
  });
}

}  // namespace rosflight::sim
