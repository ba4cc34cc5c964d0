// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "flight/gazebo/engine_block.hpp"

namespace rosflight::flight::gazebo {

/// A world of Gazebo's physics engine, dartsim, with one vehicle in it: its equations of motion, its gravity, its
/// contacts. Every function throws std::runtime_error, one line: SDF that is broken or refers to a file that is missing, a
/// world that has a model with the vehicle's name, a library that is missing.
class DartWorld {
 public:
  /// @param model_sdf   the vehicle; its link `base_link` is the body.
  /// @param world_file  empty: nothing but the vehicle.
  DartWorld(const std::string& model_sdf, const std::filesystem::path& world_file,
            double gravity_m_s2);
  ~DartWorld();

  void set_state(const Block& block);
  /// Throws if the vehicle, where the block has it, is more than kMaxOverlap_m inside a body of the world, or more than
  /// max_height_m of the block above the ground, or where there is none.
  void check_place(const Block& block);
  /// All files that were read, the world's first. Each one once.
  std::vector<std::string> files() const;
  /// Moves by block.step_s under the load of the block; then contacts and state are in the block.
  void move(Block& block);
  void read_state(Block& block) const;

  static constexpr double kMaxOverlap_m = 0.05;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace rosflight::flight::gazebo
