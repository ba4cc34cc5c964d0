// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/command.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/pid.hpp"

namespace rosflight::core {

/// Turns the command vector into forces and torques for the mixer.
///
/// entry      type          output
/// 3, 4       angle         angle PID, derivative = body rate
/// 3, 4, 5    rate          rate PID, derivative filtered
/// 0, 1       throttle      + c * max_throttle * max_thrust
/// 2          throttle      - c * max_throttle * max_thrust      (up is negative z)
/// else                     as it is
/// and entries 3..5 get the equilibrium torque on top, always.
class Controller {
 public:
  using Output = std::array<float, kEntries>;

  struct Config {
    Pid::Gains roll_rate{0.07f, 0, 0}, pitch_rate{0.07f, 0, 0}, yaw_rate{0.25f, 0, 0};
    Pid::Gains roll_angle{0.15f, 0, 0.05f}, pitch_angle{0.15f, 0, 0.05f};
    float tau_s{0.05f};
    std::array<float, 3> equilibrium_torque{};
    float max_throttle{0.7f};
    float max_thrust_N{1.0f};  ///< 1 unless the mixer works in newtons.
  };

  /// Gains change in flight without a step in the integrals' time history.
  void configure(const Config& config);
  /// All loops start from rest: on arming.
  void reset();

  /// @param saturated  the mixer could not give what was asked for last time: integrals wait.
  const Output& step(const CommandVector& command, const AttitudeEstimate& state, float dt_s,
                     bool armed, bool saturated);

  /// Torques that the pilot's present stick command asks for, level and at rest: what the sticks
  /// trim away (equilibrium-torque capture).
  std::array<float, 3> trim(const CommandVector& pilot) const;

  const Output& output() const { return output_; }

 private:
  struct Axis {
    Pid rate;
    Pid angle;
    CommandType last{CommandType::kPassThrough};
  };
  struct Moment {
    float angle, rate, dt_s, tau_s, limit;
    bool integrate;
  };
  static float run_axis(Axis& axis, CommandType type, float command, const Moment& m);

  Config config_{};
  std::array<Axis, 3> axes_{};
  Output output_{};
};

}  // namespace rosflight::core
