// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/controller.hpp"
#include "autonomy/multirotor/state_machine.hpp"
#include "rosflight_common/live_parameters.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;

/// What the controller node lets be changed while it runs.
struct Tuning {
  autonomy::multirotor::ControllerConfig controller{};
  autonomy::multirotor::StateMachineConfig states{};
};

/// Parameters of roscopter's controller over Tuning, in its units: degrees, and units of gravity
/// where an acceleration comes out. Which is which: docs/autonomy/roscopter.md.
rosflight::config::Table<Tuning> controller_parameters();

}  // namespace roscopter
