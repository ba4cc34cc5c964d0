// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/math/Inertial.hh>

#include <ignition/gazebo/components/Component.hh>

namespace ignition::gazebo {
inline namespace v6 {
namespace components {

using Inertial = Component<math::Inertiald, class InertialTag>;

}  // namespace components
}  // namespace v6
}  // namespace ignition::gazebo
