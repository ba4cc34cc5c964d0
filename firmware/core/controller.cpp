// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/controller.hpp"

#include <Eigen/Geometry>

namespace rosflight::core {
namespace {

constexpr float kThrottleForIntegration = 0.1f;
constexpr float kMaxIntegrationStep_s = 0.01f;

/// Squared sines of half the tilts, 60 and 75 degrees, between which the angle errors are blended
/// from differences to a rotation.
constexpr float kModerateTilt = 0.25f;
constexpr float kSteepTilt = 0.37f;

/// (1 - cos tilt)/2.
float half_tilt_squared(const Quaternion& q) {
  return q.x * q.x + q.y * q.y;
}

/// Gravity's direction in the body axes of an attitude: the last row of R(q_WB).
Vector3 down_B(const Quaternion& q) {
  return {2.0f * (q.x * q.z - q.y * q.w), 2.0f * (q.y * q.z + q.x * q.w),
          1.0f - 2.0f * (q.x * q.x + q.y * q.y)};
}

/// (1) as a rotation vector [rad]. Half a turn, which has no shortest axis, is one about x.
Vector3 shortest_rotation(const Vector3& wanted, const Vector3& down) {
  constexpr float kParallel = 1e-6f;
  const Vector3 axis = wanted.cross(down);
  const float sine = std::sqrt(axis.squaredNorm());
  const float cosine = wanted.dot(down);
  if (sine < kParallel) return cosine > 0.0f ? axis : Vector3{kPi, 0.0f, 0.0f};
  return axis * (atan2(sine, cosine) / sine);
}

}  // namespace

void Controller::configure(const Config& config) {
  config_ = config;
  axes_[0].rate.configure(config.roll_rate);
  axes_[1].rate.configure(config.pitch_rate);
  axes_[2].rate.configure(config.yaw_rate);
  axes_[0].angle.configure(config.roll_angle);
  axes_[1].angle.configure(config.pitch_angle);
}

void Controller::reset() {
  for (Axis& axis : axes_) {
    axis.rate.reset();
    axis.angle.reset();
  }
}

Controller::AngleErrors Controller::steep_errors(const CommandVector& command,
                                                 const AttitudeEstimate& state) {
  AngleErrors e{command.value[3] - state.roll_rad, command.value[4] - state.pitch_rad};
  if (command.type[3] != CommandType::kAngle) return e;
  const bool pitch_commanded = command.type[4] == CommandType::kAngle;
  const auto [sr, cr] = sin_cos(command.value[3]);
  const auto [sp, cp] = sin_cos(pitch_commanded ? command.value[4] : state.pitch_rad);
  const Vector3 rotation = shortest_rotation({-sp, sr * cp, cr * cp}, down_B(state.q_WB));
  float share = (half_tilt_squared(state.q_WB) - kModerateTilt) / (kSteepTilt - kModerateTilt);
  if (share > 1.0f) share = 1.0f;
  e.roll += share * (rotation.x() - e.roll);
  e.pitch += share * (rotation.y() - e.pitch);
  return e;
}

[[gnu::always_inline]] inline float Controller::run_axis(Axis& axis, CommandType type,
                                                         float command, const Moment& m) {
  if (type != axis.last) {
    axis.rate.reset();
    axis.angle.reset();
    axis.last = type;
  }
  if (type == CommandType::kRate) {
    const float x_dot = axis.rate.derivative(m.rate, m.dt_s, m.tau_s);
    return axis.rate.step(command - m.rate, x_dot, m.dt_s, m.integrate, m.saturated, m.limit);
  }
  return axis.angle.step(m.error, m.rate, m.dt_s, m.integrate, m.saturated, m.limit);
}

[[gnu::always_inline]] inline const Controller::Output& Controller::run(
    const CommandVector& command, const AttitudeEstimate& state, float dt_s, bool armed,
    bool saturated, const AngleErrors& errors) {
  const bool throttle_up = command.value[0] > kThrottleForIntegration ||
                           command.value[1] > kThrottleForIntegration ||
                           command.value[2] > kThrottleForIntegration;
  Moment m{};
  m.dt_s = dt_s;
  m.tau_s = config_.tau_s;
  m.limit = config_.max_thrust_N;  // full normalised torque, or full thrust on a lever of 1 m
  m.integrate = armed && throttle_up && dt_s < kMaxIntegrationStep_s;
  m.saturated = saturated;

  output_ = command.value;
  for (std::size_t k = 0; k < 3; ++k) {
    const CommandType type = command.type[3 + k];
    const bool closed = type == CommandType::kRate || (type == CommandType::kAngle && k < 2);
    float torque = command.value[3 + k];
    if (closed) {
      m.error = k == 0 ? errors.roll : errors.pitch;
      m.rate = state.rates_rad_s[static_cast<Eigen::Index>(k)];
      torque = run_axis(axes_[k], type, torque, m);
    } else {
      axes_[k].last = type;
    }
    output_[3 + k] = torque + config_.equilibrium_torque[k];
  }
  const float throttle_scale = config_.max_throttle * config_.max_thrust_N;
  for (std::size_t k = 0; k < 3; ++k) {
    if (command.type[k] == CommandType::kThrottle) {
      output_[k] = (k == 2 ? -1.0f : 1.0f) * command.value[k] * throttle_scale;
    }
  }
  return output_;
}

const Controller::Output& Controller::step(const CommandVector& command,
                                           const AttitudeEstimate& state, float dt_s, bool armed,
                                           bool saturated) {
  if (!(half_tilt_squared(state.q_WB) <= kModerateTilt)) {
    return step_steep(command, state, dt_s, armed, saturated);
  }
  return run(command, state, dt_s, armed, saturated,
             {command.value[3] - state.roll_rad, command.value[4] - state.pitch_rad});
}

/// A function of its own, so that step() does not pay for it.
[[gnu::noinline]] const Controller::Output& Controller::step_steep(const CommandVector& command,
                                                                   const AttitudeEstimate& state,
                                                                   float dt_s, bool armed,
                                                                   bool saturated) {
  return run(command, state, dt_s, armed, saturated, steep_errors(command, state));
}

std::array<float, 3> Controller::trim(const CommandVector& pilot) const {
  const std::array<float, 3> rate_gain{config_.roll_rate.p, config_.pitch_rate.p,
                                       config_.yaw_rate.p};
  const std::array<float, 2> angle_gain{config_.roll_angle.p, config_.pitch_angle.p};
  std::array<float, 3> torque{};
  for (std::size_t k = 0; k < 3; ++k) {
    const CommandType type = pilot.type[3 + k];
    float gain = 1.0f;
    if (type == CommandType::kRate) gain = rate_gain[k];
    if (type == CommandType::kAngle && k < 2) gain = angle_gain[k];
    torque[k] = gain * pilot.value[3 + k];
  }
  return torque;
}

}  // namespace rosflight::core
