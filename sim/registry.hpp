// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sim/modules.hpp"
#include "sim/vehicle.hpp"
#include "sim/world_sensors/world_sensor.hpp"

namespace rosflight::sim {

/// Named things of one kind.
template <class Thing>
class Catalogue {
 public:
  /// @param kind  for messages, such as "vehicle".
  explicit Catalogue(std::string kind) : kind_{std::move(kind)} {}

  /// Throws config::Error if the name is taken or empty.
  void add(std::string name, Thing thing) {
    if (name.empty()) throw config::Error(kind_ + ": found an empty name, allowed a word");
    const auto [place, is_new] = things_.emplace(std::move(name), std::move(thing));
    if (!is_new)
      throw config::Error(kind_ + " " + place->first +
                          ": found a second one, allowed one of a name");
  }
  /// There is something with that name.
  bool has(std::string_view name) const { return things_.find(name) != things_.end(); }
  /// Throws config::Error with all names if there is none of this name.
  const Thing& at(std::string_view name) const {
    const auto found = things_.find(name);
    if (found == things_.end()) {
      throw config::Error(kind_ + ": found " + std::string(name) + ", allowed " + listed());
    }
    return found->second;
  }
  /// Names in alphabetical order.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    all.reserve(things_.size());
    for (const auto& entry : things_) all.push_back(entry.first);
    return all;
  }

 private:
  std::string listed() const {
    std::string all;
    for (const auto& entry : things_) all += (all.empty() ? "" : ", ") + entry.first;
    return all.empty() ? "none: nothing is registered" : all;
  }

  std::string kind_;
  std::map<std::string, Thing, std::less<>> things_;
};

template <class Module>
using Factory =
    std::function<std::unique_ptr<Module>(const Vehicle& vehicle, const RandomSource& random)>;

/// Exchangeable modules by name: those of the project and those of plugins, alike.
///
/// A plugin is a shared library with one function
///
///     extern "C" void rosflight_register(rosflight::sim::Registry& registry);
///
/// that adds factories; examples/custom_drag is one. Libraries stay loaded as long as the registry
/// lives, which must therefore outlive every module it made. A plugin must be built with the
/// headers and the compiler of the program that loads it.
class Registry {
  std::vector<std::shared_ptr<void>> libraries_;  ///< First: their factories must go before them.
  std::filesystem::path vehicles_folder_;

 public:
  /// Forces and moments: `type` of a vehicle file.
  Catalogue<Factory<ForcesAndMoments>> forces{"type"};
  Catalogue<Factory<SensorsModule>> sensors{"sensors module"};
  Catalogue<Factory<Visualiser>> visualisers{"visualiser"};
  /// Sensors of the world: `type` in the section `world_sensors` of a vehicle file.
  Catalogue<WorldSensorFactory> world_sensors{"world sensor"};
  /// Vehicle files.
  Catalogue<std::filesystem::path> vehicles{"vehicle"};

  Registry() = default;
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Loads a plugin. Throws config::Error if it cannot be loaded, has no rosflight_register, or
  /// uses a taken name.
  void load_plugin(const std::filesystem::path& library);

  /// Adds every *.yaml of a folder under its stem. Throws
  /// config::Error if there is no such folder.
  void add_vehicles(const std::filesystem::path& folder);
  /// File of a vehicle: a name known here, or a path (it has a '/' or ends with .yaml).
  std::filesystem::path vehicle_file(const std::string& name_or_path) const;
  /// Reads that file. Its `extends` and the names looked for are those of the folder added last.
  /// @param overrides  "section.key=value", or the same after "vehicle.".
  /// Throws config::Error.
  Vehicle open_vehicle(const std::string& name_or_path, std::vector<std::string> overrides) const;

  /// The module that `vehicle.type()` names; afterwards vehicle.finish() has found no unknown key.
  std::unique_ptr<ForcesAndMoments> make_forces(const Vehicle& vehicle,
                                                const RandomSource& random) const;
};

/// Adds the forces-and-moments modules of this folder: "multirotor", "fixedwing", "quadplane".
void register_physics(Registry& registry);

}  // namespace rosflight::sim
