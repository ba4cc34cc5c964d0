// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/gazebo/EventManager.hh>
#include <ignition/gazebo/Types.hh>
#include <memory>
#include <sdf/Element.hh>

namespace ignition::gazebo {
inline namespace v6 {

class System {
 public:
  System() = default;
  virtual ~System() = default;
};

// As Gazebo's, without virtual destructors: they are deleted as a System.
class ISystemConfigure {
 public:
  virtual void Configure(const Entity& entity, const std::shared_ptr<const sdf::Element>& sdf,
                         EntityComponentManager& ecm, EventManager& events) = 0;
};

class ISystemPreUpdate {
 public:
  virtual void PreUpdate(const UpdateInfo& info, EntityComponentManager& ecm) = 0;
};

class ISystemPostUpdate {
 public:
  virtual void PostUpdate(const UpdateInfo& info, const EntityComponentManager& ecm) = 0;
};

}  // namespace v6
}  // namespace ignition::gazebo
