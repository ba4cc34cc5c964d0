// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/learned_controller.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {

void LearnedController::reset() {
  end_ = End::kNone;
  flying_ = false;
}

void LearnedController::step(const CommandVector& command, const AttitudeEstimate& state,
                             float dt_s, bool may_fly) {
  const bool angles = command.type[3] == CommandType::kAngle &&
                      command.type[4] == CommandType::kAngle &&
                      command.type[5] == CommandType::kRate;
  flying_ = may_fly && angles && end_ == End::kNone && flies(command, state, dt_s);
  if (!flying_) return;
  commanded_ = command;
  for (std::size_t k = 0; k < outputs_.size(); ++k) {
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
  const Vector3 down_B = rotation_matrix(state.q_WB).row(2).transpose();
  if (!(down_B.z() >= 0.0f)) {  // in this order a NaN counts as a tilt
    end_ = End::kTilt;
    return false;
  }
  wait_s_ -= flying_ ? dt_s : 0.0f;
  if (wait_s_ > 0.5f * dt_s) return true;
  wait_s_ = std::max(wait_s_, -dt_s) + policy_->period_s;
  return infer(command, state, down_B);
}

bool LearnedController::infer(const CommandVector& command, const AttitudeEstimate& state,
                              const Vector3& down_B) {
  const Vector3& w = state.rates_rad_s;
  outputs_ = policy_->step(
      states_, {down_B.x(), down_B.y(), down_B.z(), w.x(), w.y(), w.z(), command.value[3],
                command.value[4], command.value[5], outputs_[0], outputs_[1], outputs_[2]});
  const auto bad = std::find_if(outputs_.begin(), outputs_.end(),
                                [](float y) { return !(std::abs(y) <= 1.0f); });
  if (bad == outputs_.end()) return true;
  bad_output_ = *bad;
  end_ = End::kOutput;
  return false;
}

}  // namespace rosflight::core
