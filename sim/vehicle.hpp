// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "config/strict_yaml.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/environment/environment.hpp"

namespace rosflight::sim {

/// A vehicle file: one YAML for simulator, firmware parameters and autonomy gains.
///
/// | section               | read by                                             |
/// |-----------------------|-----------------------------------------------------|
/// | type                  | here: name of the forces-and-moments module         |
/// | body, ground, environment | here                                            |
/// | sensors               | the sensors module                                  |
/// | world_sensors         | sim/world_sensors; none without it                  |
/// | firmware              | the program that starts the firmware: parameter name: value |
/// | autonomy              | autonomy                                            |
/// | all others            | the forces-and-moments module, from root()          |
///
/// A file may begin with `extends: FILE`: it then holds only what differs. FILE is looked for in its own
/// folder, then in a library of vehicles; without an extension it is FILE.yaml. Maps are merged key by key, everything else is replaced.
///
/// Each owner finishes its own section. When the forces-and-moments module has read its sections,
/// finish() rejects unknown top-level keys. Numbers used twice are YAML anchors (&mass,
/// *mass).
class Vehicle {
 public:
  /// Reads the file and applies overrides "section.key=value" in order.
  /// @param library  folder of vehicles that others may extend; empty: none.
  /// Throws config::Error: one line FILE:LINE: KEY: found X, allowed Y.
  static Vehicle from_file(const std::filesystem::path& file,
                           const std::vector<std::string>& overrides = {},
                           const std::filesystem::path& library = {});
  /// @throws config::Error  a section of this class has an error.
  explicit Vehicle(config::Document document);

  const std::string& type() const { return type_; }
  const BodyParameters& body() const { return body_; }
  const GroundParameters& ground() const { return ground_; }
  const EnvironmentParameters& environment() const { return environment_; }

  const config::Section& root() const { return root_; }
  const config::Section& sensors() const { return sensors_; }
  const config::Section& world_sensors() const { return world_sensors_; }
  const config::Section& firmware() const { return firmware_; }
  const config::Section& autonomy() const { return autonomy_; }

  /// Throws if a key outside sensors, world_sensors, firmware and autonomy was never asked for.
  void finish() const { root_.finish(); }
  /// Lets go of the file, most of the memory of a vehicle: its sections are empty then.
  void drop_file();
  /// The file with its overrides as YAML, for the flight folder.
  std::string text() const { return document_.text(); }

 private:
  config::Document document_;
  config::Section root_;
  std::string type_;
  BodyParameters body_;
  GroundParameters ground_;
  EnvironmentParameters environment_;
  config::Section sensors_;
  config::Section world_sensors_;
  config::Section firmware_;
  config::Section autonomy_;
};

}  // namespace rosflight::sim
