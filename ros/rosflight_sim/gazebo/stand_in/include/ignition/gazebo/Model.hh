// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/math/Pose3.hh>
#include <string>

namespace ignition::gazebo {
inline namespace v6 {

class Model {
 public:
  explicit Model(gazebo::Entity entity = kNullEntity) : entity_{entity} {}
  gazebo::Entity Entity() const { return entity_; }
  bool Valid(const EntityComponentManager& ecm) const;
  std::string Name(const EntityComponentManager& ecm) const;
  /// Not const in this release. kNullEntity: there is none.
  gazebo::Entity LinkByName(const EntityComponentManager& ecm, const std::string& name);
  void SetWorldPoseCmd(EntityComponentManager& ecm, const math::Pose3d& pose);

 private:
  gazebo::Entity entity_;
};

}  // namespace v6
}  // namespace ignition::gazebo
