// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/Types.hh>
#include <ignition/gazebo/components/Component.hh>
#include <map>
#include <memory>
#include <typeindex>
#include <utility>

namespace rosflight_sim {
class StandInAccess;
}

namespace ignition::gazebo {
inline namespace v6 {

/// Components of entities. Entities are made by the server alone.
class EntityComponentManager {
 public:
  EntityComponentManager() = default;
  EntityComponentManager(const EntityComponentManager&) = delete;
  EntityComponentManager& operator=(const EntityComponentManager&) = delete;

  /// Replaces the data of a component that is there. nullptr: there is no such entity.
  template <typename ComponentTypeT>
  ComponentTypeT* CreateComponent(const Entity entity, const ComponentTypeT& data) {
    if (entity == kNullEntity || entity > newest_) return nullptr;
    auto& at = components_[{entity, typeid(ComponentTypeT)}];
    at = std::make_unique<ComponentTypeT>(data);
    return static_cast<ComponentTypeT*>(at.get());
  }
  template <typename ComponentTypeT>
  const ComponentTypeT* Component(const Entity entity) const {
    const auto found = components_.find({entity, typeid(ComponentTypeT)});
    return found == components_.end() ? nullptr
                                      : static_cast<const ComponentTypeT*>(found->second.get());
  }
  template <typename ComponentTypeT>
  ComponentTypeT* Component(const Entity entity) {
    const auto found = components_.find({entity, typeid(ComponentTypeT)});
    return found == components_.end() ? nullptr : static_cast<ComponentTypeT*>(found->second.get());
  }
  template <typename ComponentTypeT>
  bool RemoveComponent(Entity entity) {
    return components_.erase({entity, typeid(ComponentTypeT)}) > 0;
  }

 private:
  friend class rosflight_sim::StandInAccess;
  using Key = std::pair<Entity, std::type_index>;
  std::map<Key, std::unique_ptr<components::BaseComponent>> components_;
  Entity newest_{kNullEntity};
};

}  // namespace v6
}  // namespace ignition::gazebo
