// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/math/Pose3.hh>
#include <ignition/math/Vector3.hh>
#include <string>

namespace rosflight_sim {

namespace gz = ignition::gazebo;
using ignition::math::Pose3d;
using ignition::math::Vector3d;

/// What only the server and its Link and Model know: a plugin does not include this.
struct WrenchAtOrigin {
  Vector3d force;
  Vector3d torque;
};
using Name = gz::components::Component<std::string, class NameTag>;
using IsModel = gz::components::Component<bool, class IsModelTag>;
using Parent = gz::components::Component<gz::Entity, class ParentTag>;
using Pose = gz::components::Component<Pose3d, class PoseTag>;  ///< In the parent.
using WorldPose = gz::components::Component<Pose3d, class WorldPoseTag>;
using WorldLinearVelocity = gz::components::Component<Vector3d, class WorldLinearVelocityTag>;
using WorldAngularVelocity = gz::components::Component<Vector3d, class WorldAngularVelocityTag>;
using ExternalWorldWrenchCmd = gz::components::Component<WrenchAtOrigin, class WrenchCmdTag>;

class StandInAccess {
 public:
  static gz::Entity make_entity(gz::EntityComponentManager& ecm) { return ++ecm.newest_; }
  static gz::Entity newest(const gz::EntityComponentManager& ecm) { return ecm.newest_; }
};

}  // namespace rosflight_sim
