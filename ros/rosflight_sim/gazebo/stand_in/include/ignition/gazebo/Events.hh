// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <ignition/gazebo/EventManager.hh>

namespace ignition::gazebo {
inline namespace v6 {
namespace events {

using Pause = common::EventT<void(bool), struct PauseTag>;
using Stop = common::EventT<void(void), struct StopTag>;

}  // namespace events
}  // namespace v6
}  // namespace ignition::gazebo
