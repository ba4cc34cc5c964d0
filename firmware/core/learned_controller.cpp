// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/learned_controller.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

Vector3 gravity_direction_B(const AttitudeEstimate& state) {
  return rotation_matrix(state.q_WB).row(2).transpose();
}

}  // namespace

void LearnedController::reset() {
  end_ = End::kNone;
  flying_ = false;
}

Policy::Inputs LearnedController::inputs(const CommandVector& command,
                                         const AttitudeEstimate& state, const Policy::Outputs& last,
                                         std::size_t throttle_axis) {
  const Vector3 down_B = gravity_direction_B(state);
  const Vector3& w = state.rates_rad_s;
  return {down_B.x(),
          down_B.y(),
          down_B.z(),
          w.x(),
          w.y(),
          w.z(),
          command.value[3],
          command.value[4],
          command.value[5],
          last[0],
          last[1],
          last[2],
          last[3],
          command.value[throttle_axis]};
}

void LearnedController::step(const CommandVector& command, const AttitudeEstimate& state,
                             float dt_s, bool may_fly) {
  const bool angles = command.type[3] == CommandType::kAngle &&
                      command.type[4] == CommandType::kAngle &&
                      command.type[5] == CommandType::kRate;
  const bool throttle = !of_motors() || command.type[throttle_axis_] == CommandType::kThrottle;
  flying_ = may_fly && angles && throttle && end_ == End::kNone && flies(command, state, dt_s);
  if (!flying_) return;
  if (of_motors()) {
    for (std::size_t k = 0; k < motors_.size(); ++k) motors_[k] = 0.5f * (outputs_[k] + 1.0f);
    return;
  }
  commanded_ = command;
  for (std::size_t k = 0; k < max_rates_.size(); ++k) {
    commanded_.type[3 + k] = CommandType::kRate;
    commanded_.value[3 + k] = outputs_[k] * max_rates_[k];
  }
}

/// @returns whether the policy flies this step; it is allowed to.
bool LearnedController::flies(const CommandVector& command, const AttitudeEstimate& state,
                              float dt_s) {
  if (!flying_) {
    states_.fill(0.0f);
    outputs_.fill(0.0f);
    wait_s_ = 0.0f;
  }
  if (!(gravity_direction_B(state).z() >= 0.0f)) {  // in this order a NaN counts as a tilt
    end_ = End::kTilt;
    return false;
  }
  wait_s_ -= flying_ ? dt_s : 0.0f;
  if (wait_s_ > 0.5f * dt_s) return true;
  wait_s_ = std::max(wait_s_, -dt_s) + policy_->period_s;
  return infer(command, state);
}

bool LearnedController::infer(const CommandVector& command, const AttitudeEstimate& state) {
  outputs_ = policy_->step(states_, inputs(command, state, outputs_, throttle_axis_));
  const auto bad = std::find_if(outputs_.begin(), outputs_.end(),
                                [](float y) { return !(std::abs(y) <= 1.0f); });
  if (bad == outputs_.end()) return true;
  bad_output_ = *bad;
  end_ = End::kOutput;
  return false;
}

}  // namespace rosflight::core
