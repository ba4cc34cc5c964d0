// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <filesystem>
#include <ignition/gazebo/System.hh>
#include <ignition/plugin/Loader.hh>
#include <memory>
#include <sdf/sdf.hh>
#include <string>
#include <vector>

#include "flight/gazebo/engine/dart_world.hpp"

namespace rosflight_sim {

/// A world file with one vehicle in place of Gazebo's server: dartsim in this process, and the systems that the vehicle names,
/// called as the server of ignition-gazebo 6.4 calls them.
///
/// One iteration: PreUpdate of all; physics; PostUpdate of each in a thread of its own. While it is paused all of them are called,
/// and nothing moves. The physics does what src/systems/physics/Physics.cc does, in its order: it applies and then
/// clears the wrench, also while paused, when nothing moves; obeys a pose command in two iterations; turns velocity commands by
/// the pose that the model had before, obeys them in each iteration, and leaves zeros of them.
class StandInWorld {
 public:
  /// @throws std::runtime_error  one line: world file, plugin.
  explicit StandInWorld(const std::filesystem::path& world_file);
  ~StandInWorld();

  void iterate();
  void set_paused(bool paused) { paused_ = paused; }
  bool paused() const { return paused_; }
  bool stopped() const { return stopped_; }
  /// Wall time of one iteration; zero: as fast as it goes.
  std::chrono::nanoseconds period() const { return period_; }

 private:
  struct LoadedSystem;
  void read(const std::filesystem::path& world_file);
  void load(const sdf::ElementPtr& plugin);
  void update_physics();
  void update_components();

  ignition::gazebo::EntityComponentManager ecm_;
  ignition::gazebo::EventManager events_;
  ignition::gazebo::UpdateInfo info_;
  ignition::gazebo::Entity model_{ignition::gazebo::kNullEntity};
  ignition::gazebo::Entity link_{ignition::gazebo::kNullEntity};
  sdf::Root root_;
  std::unique_ptr<rosflight::flight::gazebo::DartWorld> dart_;
  rosflight::flight::gazebo::Block block_{};
  ignition::plugin::Loader loader_;
  std::vector<LoadedSystem> systems_;
  std::chrono::nanoseconds step_{};
  std::chrono::nanoseconds period_{};
  bool paused_{false};
  bool stopped_{false};
  bool pose_was_obeyed_{false};
};

}  // namespace rosflight_sim
