// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/command.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/policy.hpp"

namespace rosflight::core {

/// Flies by the policy of the build: a network commands body rates in place of the angle loops of
/// Controller, whose rate loops and throttle stay; or four motors in place of Controller and the gains of Mixer.
///
///     y   = policy(d, w, roll_c, pitch_c, yaw_rate_c, last y, throttle_c)                 (1)
///     w_c = y_k w_max,k                                                                   (2)
///     m_k = (y_k + 1) / 2                                                                 (3)
///
/// with the inputs of Policy. It flies while roll and pitch are commanded as angles and yaw as a rate, and motors while
/// a throttle is commanded too.
/// An output that is not a number within -1..1, or a tilt beyond 90 degrees, ends its flying: from
/// that step on the command goes on as it came, until reset(). Owns 0.4 kB, no heap.
class LearnedController {
 public:
  /// Why it no longer flies.
  enum class End : std::uint8_t { kNone, kOutput, kTilt };

  /// @param policy  has to outlive this; nullptr: never flies.
  explicit LearnedController(const Policy* policy) : policy_{policy} {}

  /// The build has a policy.
  bool built_in() const { return policy_ != nullptr; }
  const Policy* policy() const { return policy_; }
  /// @param max_rates_rad_s  about body x, y and z: what an output of 1 commands.
  /// @param throttle_axis    of the command vector, 0 to 2.
  void configure(const std::array<float, 3>& max_rates_rad_s, std::size_t throttle_axis) {
    max_rates_ = max_rates_rad_s;
    throttle_axis_ = throttle_axis;
  }

  /// It may fly again: at a disarming.
  void reset();

  /// What a policy gets of a command and an estimate; the environment that policies are trained in gives the same.
  static Policy::Inputs inputs(const CommandVector& command, const AttitudeEstimate& state,
                               const Policy::Outputs& last, std::size_t throttle_axis);

  /// Requires built_in().
  /// @param may_fly  false: the command goes on as it came, and the network starts from rest later.
  /// @param dt_s     time since the previous step [s].
  void step(const CommandVector& command, const AttitudeEstimate& state, float dt_s, bool may_fly);

  End end() const { return end_; }
  /// The output that ended it; with End::kOutput.
  float bad_output() const { return bad_output_; }
  /// The last step commanded rates or motors.
  bool flying() const { return flying_; }
  /// The policy is one of motors.
  bool of_motors() const { return built_in() && policy_->kind == Policy::Kind::kMotorOutputs; }
  /// The command of the last step for Controller; with flying(), unless of_motors().
  const CommandVector& commanded() const { return commanded_; }
  /// (3) of the last step; with flying() and of_motors().
  const std::array<float, Policy::kMotorCount>& motors() const { return motors_; }

 private:
  bool flies(const CommandVector& command, const AttitudeEstimate& state, float dt_s);
  bool infer(const CommandVector& command, const AttitudeEstimate& state);

  const Policy* policy_;
  std::array<float, 3> max_rates_{};
  Policy::States states_{};
  Policy::Outputs outputs_{};
  CommandVector commanded_{};
  std::array<float, Policy::kMotorCount> motors_{};
  std::size_t throttle_axis_{2};
  float wait_s_{0.0f};  ///< To the next inference.
  float bad_output_{0.0f};
  End end_{End::kNone};
  bool flying_{false};
};

}  // namespace rosflight::core
