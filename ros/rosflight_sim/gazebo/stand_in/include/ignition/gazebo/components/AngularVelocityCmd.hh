// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/math/Vector3.hh>

#include <ignition/gazebo/components/Component.hh>

namespace ignition::gazebo {
inline namespace v6 {
namespace components {

using AngularVelocityCmd = Component<math::Vector3d, class AngularVelocityCmdTag>;

}  // namespace components
}  // namespace v6
}  // namespace ignition::gazebo
