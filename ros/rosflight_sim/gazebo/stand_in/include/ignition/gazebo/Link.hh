// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/gazebo/Model.hh>
#include <ignition/math/Pose3.hh>
#include <ignition/math/Vector3.hh>
#include <optional>

namespace ignition::gazebo {
inline namespace v6 {

/// Nothing is there unless EnableVelocityChecks() asked for it; until the physics has run, it is zero.
class Link {
 public:
  explicit Link(gazebo::Entity entity = kNullEntity) : entity_{entity} {}
  gazebo::Entity Entity() const { return entity_; }
  void EnableVelocityChecks(EntityComponentManager& ecm, bool enable = true) const;
  std::optional<math::Pose3d> WorldPose(const EntityComponentManager& ecm) const;
  std::optional<math::Vector3d> WorldLinearVelocity(const EntityComponentManager& ecm) const;
  std::optional<math::Vector3d> WorldAngularVelocity(const EntityComponentManager& ecm) const;
  /// At the link's origin, for one step; several add up.
  void AddWorldWrench(EntityComponentManager& ecm, const math::Vector3d& force,
                      const math::Vector3d& torque) const;

 private:
  gazebo::Entity entity_;
};

}  // namespace v6
}  // namespace ignition::gazebo
