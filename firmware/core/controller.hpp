// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/command.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/pid.hpp"

namespace rosflight::core {

/// Turns the command vector into forces and torques for the mixer.
///
/// axis       type          output
/// 3, 4       angle         angle PID, derivative = body rate
/// 3, 4, 5    rate          rate PID, derivative filtered
/// 0, 1       throttle      + c * max_throttle * max_thrust
/// 2          throttle      - c * max_throttle * max_thrust      (up is negative z)
/// else                     unchanged
/// The equilibrium torque is added to axes 3..5, always.
///
/// The angle errors are, up to a tilt of 60 degrees, the differences of roll and pitch. Beyond 75
/// degrees, where roll and pitch lose their meaning, they are the body x and y components of the
/// shortest rotation from the present to the wanted attitude at any heading,
///
///     q_e = (1 + c . d, c x d) / |.|                                                     (1)
///
/// with d the direction of gravity in body axes and c that of the commanded roll and pitch; for an
/// error in roll alone or pitch alone both are the same. Between the two tilts they are blended.
class Controller {
 public:
  using Output = std::array<float, kAxes>;

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

  /// @param dt_s       time since the previous step [s].
  /// @param saturated  the previous output did not fit the actuators: integrals only unwind.
  const Output& step(const CommandVector& command, const AttitudeEstimate& state, float dt_s,
                     bool armed, bool saturated);

  /// Torques that the present stick command produces, level and at rest: the equilibrium torques of
  /// a vehicle that flies straight under this command.
  std::array<float, 3> trim(const CommandVector& pilot) const;

  /// `u` plus the equilibrium torques, for commands that reach the mixer without a loop.
  Output trimmed(const Output& u) const {
    Output sum = u;
    for (std::size_t k = 0; k < 3; ++k) sum[3 + k] += config_.equilibrium_torque[k];
    return sum;
  }

  const Output& output() const { return output_; }

 private:
  struct Axis {
    Pid rate;
    Pid angle;
    CommandType last{CommandType::kPassThrough};
  };
  struct Moment {
    float error, rate, dt_s, tau_s, limit;
    bool integrate, saturated;
  };
  struct AngleErrors {
    float roll, pitch;
  };
  static AngleErrors steep_errors(const CommandVector& command, const AttitudeEstimate& state);
  const Output& step_steep(const CommandVector& command, const AttitudeEstimate& state, float dt_s,
                           bool armed, bool saturated);
  const Output& run(const CommandVector& command, const AttitudeEstimate& state, float dt_s,
                    bool armed, bool saturated, const AngleErrors& errors);
  static float run_axis(Axis& axis, CommandType type, float command, const Moment& m);

  Config config_{};
  std::array<Axis, 3> axes_{};
  Output output_{};
};

}  // namespace rosflight::core
