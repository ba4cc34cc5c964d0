// SPDX-License-Identifier: BSD-3-Clause
// The stand-in's Link, Model and worldPose(), as src/Link.cc, Model.cc and Util.cc of ignition-gazebo 6.4 behave.
#include <ignition/gazebo/Link.hh>
#include <ignition/gazebo/Model.hh>
#include <ignition/gazebo/Util.hh>
#include <ignition/gazebo/components/PoseCmd.hh>

#include "stand_in_components.hpp"

namespace ignition::gazebo {
inline namespace v6 {

using rosflight_sim::ExternalWorldWrenchCmd;
using rosflight_sim::IsModel;
using rosflight_sim::Parent;
using rosflight_sim::StandInAccess;

namespace {

template <class ComponentT>
std::optional<typename ComponentT::Type> data(const EntityComponentManager& ecm,
                                              gazebo::Entity entity) {
  const auto* component = ecm.Component<ComponentT>(entity);
  if (component == nullptr) return std::nullopt;
  return component->Data();
}

template <class ComponentT>
void enable(EntityComponentManager& ecm, gazebo::Entity entity, bool on) {
  if (!on) {
    ecm.RemoveComponent<ComponentT>(entity);
  } else if (ecm.Component<ComponentT>(entity) == nullptr) {
    ecm.CreateComponent(entity, ComponentT());
  }
}

}  // namespace

bool Model::Valid(const EntityComponentManager& ecm) const {
  return ecm.Component<IsModel>(entity_) != nullptr;
}

std::string Model::Name(const EntityComponentManager& ecm) const {
  return data<rosflight_sim::Name>(ecm, entity_).value_or("");
}

gazebo::Entity Model::LinkByName(const EntityComponentManager& ecm, const std::string& name) {
  for (gazebo::Entity entity = 1; entity <= StandInAccess::newest(ecm); ++entity) {
    if (data<Parent>(ecm, entity) == entity_ && ecm.Component<IsModel>(entity) == nullptr &&
        data<rosflight_sim::Name>(ecm, entity) == name)
      return entity;
  }
  return kNullEntity;
}

void Model::SetWorldPoseCmd(EntityComponentManager& ecm, const math::Pose3d& pose) {
  ecm.CreateComponent(entity_, components::WorldPoseCmd(pose));
}

void Link::EnableVelocityChecks(EntityComponentManager& ecm, bool on) const {
  enable<rosflight_sim::WorldLinearVelocity>(ecm, entity_, on);
  enable<rosflight_sim::WorldAngularVelocity>(ecm, entity_, on);
  enable<rosflight_sim::WorldPose>(ecm, entity_, on);
}

std::optional<math::Pose3d> Link::WorldPose(const EntityComponentManager& ecm) const {
  return data<rosflight_sim::WorldPose>(ecm, entity_);
}

std::optional<math::Vector3d> Link::WorldLinearVelocity(const EntityComponentManager& ecm) const {
  return data<rosflight_sim::WorldLinearVelocity>(ecm, entity_);
}

std::optional<math::Vector3d> Link::WorldAngularVelocity(const EntityComponentManager& ecm) const {
  return data<rosflight_sim::WorldAngularVelocity>(ecm, entity_);
}

void Link::AddWorldWrench(EntityComponentManager& ecm, const math::Vector3d& force,
                          const math::Vector3d& torque) const {
  auto* wrench = ecm.Component<ExternalWorldWrenchCmd>(entity_);
  if (wrench == nullptr) {
    ecm.CreateComponent(entity_, ExternalWorldWrenchCmd({force, torque}));
    return;
  }
  wrench->Data().force += force;
  wrench->Data().torque += torque;
}

math::Pose3d worldPose(const Entity& entity, const EntityComponentManager& ecm) {
  const math::Pose3d own = data<rosflight_sim::Pose>(ecm, entity).value_or(math::Pose3d::Zero);
  const auto parent = data<Parent>(ecm, entity);
  return parent && *parent != kNullEntity ? worldPose(*parent, ecm) * own : own;
}

}  // namespace v6
}  // namespace ignition::gazebo
