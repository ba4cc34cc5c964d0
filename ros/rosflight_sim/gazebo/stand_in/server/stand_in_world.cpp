// SPDX-License-Identifier: BSD-3-Clause
#include "stand_in_world.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <ignition/gazebo/Events.hh>
#include <ignition/gazebo/Util.hh>
#include <ignition/gazebo/components/AngularVelocityCmd.hh>
#include <ignition/gazebo/components/Inertial.hh>
#include <ignition/gazebo/components/LinearVelocityCmd.hh>
#include <ignition/gazebo/components/PoseCmd.hh>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "../stand_in_components.hpp"

namespace rosflight_sim {

using ignition::math::Matrix3d;
using ignition::math::Quaterniond;
using rosflight::flight::gazebo::DartWorld;
using rosflight::flight::gazebo::Triple;
namespace components = gz::components;

namespace {

Vector3d vector(const Triple& at) {
  return {at[0], at[1], at[2]};
}

void put(const Vector3d& v, Triple& at) {
  at = {v.X(), v.Y(), v.Z()};
}

Pose3d pose_in(const rosflight::flight::gazebo::Block& block) {
  const auto& R = block.R_GL;
  const Matrix3d rotation(R[0], R[1], R[2], R[3], R[4], R[5], R[6], R[7], R[8]);
  return {vector(block.p_G), Quaterniond(rotation)};
}

void put(const Pose3d& pose, rosflight::flight::gazebo::Block& block) {
  put(pose.Pos(), block.p_G);
  const Matrix3d rotation(pose.Rot());
  for (unsigned k = 0; k < 9; ++k) block.R_GL.at(k) = rotation(k / 3, k % 3);
}

template <class ComponentT>
void set(gz::EntityComponentManager& ecm, gz::Entity entity,
         const typename ComponentT::Type& data) {
  if (auto* component = ecm.Component<ComponentT>(entity)) component->Data() = data;
}

/// As Gazebo looks for it, in the folders of its variable.
std::string library(const std::string& name) {
  const char* const folders = std::getenv("IGN_GAZEBO_SYSTEM_PLUGIN_PATH");
  std::istringstream in(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(in, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder) / ("lib" + name + ".so");
    if (std::filesystem::exists(file)) return file;
  }
  throw std::runtime_error("found no library " + name + " in IGN_GAZEBO_SYSTEM_PLUGIN_PATH");
}

}  // namespace

struct StandInWorld::LoadedSystem {
  ignition::plugin::PluginPtr plugin;
  gz::ISystemPreUpdate* before;
  gz::ISystemPostUpdate* after;
};

StandInWorld::StandInWorld(const std::filesystem::path& world_file) {
  events_.Connect<gz::events::Pause>([this](bool paused) { paused_ = paused; });
  events_.Connect<gz::events::Stop>([this] { stopped_ = true; });
  read(world_file);
}

StandInWorld::~StandInWorld() = default;

void StandInWorld::read(const std::filesystem::path& world_file) {
  const sdf::Errors errors = root_.Load(world_file);
  if (!errors.empty()) throw std::runtime_error(errors.front().Message());
  if (root_.WorldCount() != 1) throw std::runtime_error("found no world in " + world_file.string());
  const sdf::World& world = *root_.WorldByIndex(0);
  const sdf::Model* vehicle = nullptr;
  for (std::uint64_t k = 0; k < world.ModelCount(); ++k)
    if (!world.ModelByIndex(k)->Static()) vehicle = world.ModelByIndex(k);
  if (vehicle == nullptr) throw std::runtime_error("found no model that moves");
  const sdf::Physics& physics = *world.PhysicsByIndex(0);
  step_ = std::chrono::nanoseconds(std::llround(physics.MaxStepSize() * 1e9));
  if (physics.RealTimeFactor() > 1e-9)
    period_ = std::chrono::nanoseconds(
        std::llround(physics.MaxStepSize() / physics.RealTimeFactor() * 1e9));

  model_ = StandInAccess::make_entity(ecm_);
  ecm_.CreateComponent(model_, IsModel(true));
  ecm_.CreateComponent(model_, Name(vehicle->Name()));
  ecm_.CreateComponent(model_, Pose(vehicle->RawPose()));
  for (std::uint64_t k = 0; k < vehicle->LinkCount(); ++k) {
    const sdf::Link& link = *vehicle->LinkByIndex(k);
    const gz::Entity entity = StandInAccess::make_entity(ecm_);
    if (link.Name() == vehicle->CanonicalLinkName()) link_ = entity;
    ecm_.CreateComponent(entity, Name(link.Name()));
    ecm_.CreateComponent(entity, Parent(model_));
    ecm_.CreateComponent(entity, Pose(link.RawPose()));
    ecm_.CreateComponent(entity, components::Inertial(link.Inertial()));
  }

  // dartsim gets the vehicle and the world without it.
  const std::string model_text =
      "<sdf version='1.9'>" + vehicle->Element()->ToString("") + "</sdf>";
  const double gravity_m_s2 = -world.Gravity().Z();
  const std::filesystem::path rest =
      std::filesystem::temp_directory_path() / ("stand_in_" + std::to_string(::getpid()) + ".sdf");
  sdf::ElementPtr element = world.Element()->Clone();
  for (sdf::ElementPtr child = element->GetElement("model"); child;) {
    const sdf::ElementPtr next = child->GetNextElement("model");
    if (child->Get<std::string>("name") == vehicle->Name()) child->RemoveFromParent();
    child = next;
  }
  std::ofstream(rest) << "<sdf version='1.9'>" << element->ToString("") << "</sdf>";
  dart_ = std::make_unique<DartWorld>(model_text, rest, gravity_m_s2);
  std::filesystem::remove(rest);
  dart_->read_state(block_);
  const sdf::ElementPtr described = vehicle->Element();
  if (!described->HasElement("plugin")) return;
  for (sdf::ElementPtr plugin = described->GetElement("plugin"); plugin;
       plugin = plugin->GetNextElement("plugin"))
    load(plugin);
}

void StandInWorld::load(const sdf::ElementPtr& plugin) {
  const auto file = plugin->Get<std::string>("filename");
  const auto name = plugin->Get<std::string>("name");
  const std::string library_file = library(file);
  // The wheels of ROS bring a tracing library that looks for another one when it is loaded, in vain; the loader would take what
  // dlerror() then holds for its own failure.
  static_cast<void>(::dlopen(library_file.c_str(), RTLD_NOW));
  if (loader_.LoadLib(library_file).empty()) throw std::runtime_error("found no plugin in " + file);
  const ignition::plugin::PluginPtr loaded = loader_.Instantiate(name);
  auto* const configure = loaded ? loaded->QueryInterface<gz::ISystemConfigure>() : nullptr;
  if (configure == nullptr || loaded->QueryInterface<gz::System>() == nullptr)
    throw std::runtime_error("found no system " + name + " in " + file);
  configure->Configure(model_, plugin, ecm_, events_);
  systems_.push_back({loaded, loaded->QueryInterface<gz::ISystemPreUpdate>(),
                      loaded->QueryInterface<gz::ISystemPostUpdate>()});
}

void StandInWorld::iterate() {
  info_.paused = paused_;
  info_.dt = paused_ ? std::chrono::nanoseconds{0} : step_;
  info_.simTime += info_.dt;
  if (!paused_) ++info_.iterations;
  for (const LoadedSystem& system : systems_)
    if (system.before != nullptr) system.before->PreUpdate(info_, ecm_);
  update_physics();
  std::vector<std::thread> threads;
  const auto& seen = ecm_;
  for (const LoadedSystem& system : systems_)
    if (system.after != nullptr)
      threads.emplace_back([&system, &seen, this] { system.after->PostUpdate(info_, seen); });
  for (std::thread& thread : threads) thread.join();
}

void StandInWorld::update_physics() {
  if (const auto* wrench = ecm_.Component<ExternalWorldWrenchCmd>(link_)) {
    put(vector(block_.force_G) + wrench->Data().force, block_.force_G);
    put(vector(block_.torque_G) + wrench->Data().torque, block_.torque_G);
  }
  const Pose3d link_in_model = ecm_.Component<Pose>(link_)->Data();
  const Quaterniond before = ecm_.Component<Pose>(model_)->Data().Rot();
  bool placed = false;
  const bool obeyed_before = pose_was_obeyed_;
  pose_was_obeyed_ = false;
  if (const auto* pose = ecm_.Component<components::WorldPoseCmd>(model_)) {
    put(pose->Data() * link_in_model, block_);
    placed = pose_was_obeyed_ = true;
  }
  if (obeyed_before) ecm_.RemoveComponent<components::WorldPoseCmd>(model_);
  if (const auto* w = ecm_.Component<components::AngularVelocityCmd>(model_)) {
    put(before * w->Data(), block_.w_G);
    placed = true;
  }
  if (const auto* v = ecm_.Component<components::LinearVelocityCmd>(model_)) {
    put(before * v->Data(), block_.v_G);
    placed = true;
  }
  if (placed) dart_->set_state(block_);
  if (!info_.paused) {
    block_.step_s = std::chrono::duration<double>(info_.dt).count();
    dart_->move(block_);
    block_.force_G = block_.torque_G = {};
  }
  update_components();
}

void StandInWorld::update_components() {
  const Pose3d link = pose_in(block_);
  set<Pose>(ecm_, model_, link * ecm_.Component<Pose>(link_)->Data().Inverse());
  set<WorldPose>(ecm_, link_, link);
  set<WorldLinearVelocity>(ecm_, link_, vector(block_.v_G));
  set<WorldAngularVelocity>(ecm_, link_, vector(block_.w_G));
  set<ExternalWorldWrenchCmd>(ecm_, link_, {});
  set<components::LinearVelocityCmd>(ecm_, model_, Vector3d::Zero);
  set<components::AngularVelocityCmd>(ecm_, model_, Vector3d::Zero);
}

}  // namespace rosflight_sim
