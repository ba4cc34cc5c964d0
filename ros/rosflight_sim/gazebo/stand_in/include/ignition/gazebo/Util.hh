// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EntityComponentManager.hh>
#include <ignition/math/Pose3.hh>

namespace ignition::gazebo {
inline namespace v6 {

/// By the poses of the entity and of those it belongs to.
math::Pose3d worldPose(const Entity& entity, const EntityComponentManager& ecm);

}  // namespace v6
}  // namespace ignition::gazebo
