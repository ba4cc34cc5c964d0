// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/math/Pose3.hh>

#include <ignition/gazebo/components/Component.hh>

namespace ignition::gazebo {
inline namespace v6 {
namespace components {

using WorldPoseCmd = Component<math::Pose3d, class WorldPoseCmdTag>;

}  // namespace components
}  // namespace v6
}  // namespace ignition::gazebo
