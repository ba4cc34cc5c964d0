// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/math/Vector3.hh>

#include <ignition/gazebo/components/Component.hh>

namespace ignition::gazebo {
inline namespace v6 {
namespace components {

using LinearVelocityCmd = Component<math::Vector3d, class LinearVelocityCmdTag>;

}  // namespace components
}  // namespace v6
}  // namespace ignition::gazebo
