// SPDX-License-Identifier: BSD-3-Clause
// The learned controller of a build that has a policy.
#include "firmware/core/firmware.hpp"

namespace rosflight::core {

/// A policy of motors leaves other airframes to the loops.
bool Firmware::fits_policy() const {
  return !parameters_.get_bool(Param::kFixedWing) &&
         (!learned_.of_motors() ||
          (mixer_.motor_count() == Policy::kMotorCount && !mixer_.calibrates_escs()));
}

void Firmware::describe_policy() {
  log_.info(Text("Learned controller: ").add(learned_.policy()->name));
  if (!parameters_.get_bool(Param::kFixedWing) && !fits_policy()) {
    log_.warning("Learned controller off: needs 4 motors");
  }
}

/// A policy of motors flies while the throttle is above idle: below, they turn as without it.
bool Firmware::policy_may_fly(const CommandVector& command) const {
  if (!state_.armed() || command_.in_failsafe() || !fits_policy()) return false;
  if (!learned_.of_motors()) return true;
  const float throttle = command.value[mixer_.config().throttle_axis];
  return throttle * parameters_.get_float(Param::kRcMaxThr) > mixer_.config().idle_throttle;
}

/// Once it has missed a pass it flies no more until the vehicle is disarmed.
[[gnu::noinline]] const CommandVector& Firmware::learned_command(const AttitudeEstimate& attitude,
                                                                 float dt_s) {
  const bool ended = learned_.end() != LearnedController::End::kNone;
  const bool flew_motors = learned_.flying() && learned_.of_motors();
  const CommandVector& command = command_.combined();
  learned_.step(command, attitude, dt_s, policy_may_fly(command));
  if (flew_motors && !learned_.flying()) controller_.reset();  // it did not run meanwhile
  if (!ended && learned_.end() != LearnedController::End::kNone) {
    Text text{"Learned control off until disarm: "};
    if (learned_.end() == LearnedController::End::kTilt) {
      text.add("tilt > 90 deg");
    } else {
      text.add("output ").add(learned_.bad_output(), 2);
    }
    log_.critical(text);
  }
  return learned_.flying() && !learned_.of_motors() ? learned_.commanded() : command;
}

}  // namespace rosflight::core
