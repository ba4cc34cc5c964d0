// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/controller.hpp"

namespace rosflight::core {
namespace {

constexpr float kThrottleForIntegration = 0.1f;
constexpr float kLongestIntegrationStep_s = 0.01f;

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

inline float Controller::run_axis(Axis& axis, CommandType type, float command, const Moment& m) {
  if (type != axis.last) {
    axis.rate.reset();
    axis.angle.reset();
    axis.last = type;
  }
  if (type == CommandType::kRate) {
    const float x_dot = axis.rate.derivative(m.rate, m.dt_s, m.tau_s);
    return axis.rate.step(command, m.rate, x_dot, m.dt_s, m.integrate, m.limit);
  }
  return axis.angle.step(command, m.angle, m.rate, m.dt_s, m.integrate, m.limit);
}

const Controller::Output& Controller::step(const CommandVector& command,
                                           const AttitudeEstimate& state, float dt_s, bool armed,
                                           bool saturated) {
  const bool throttle_up = command.value[0] > kThrottleForIntegration ||
                           command.value[1] > kThrottleForIntegration ||
                           command.value[2] > kThrottleForIntegration;
  Moment m{};
  m.dt_s = dt_s;
  m.tau_s = config_.tau_s;
  m.limit = config_.max_thrust_N;  // full normalised torque, or full thrust on a lever of 1 m
  m.integrate = armed && throttle_up && dt_s < kLongestIntegrationStep_s && !saturated;

  output_ = command.value;
  const std::array<float, 3> angles{state.roll_rad, state.pitch_rad, 0.0f};
  for (std::size_t k = 0; k < 3; ++k) {
    const CommandType type = command.type[3 + k];
    const bool closed = type == CommandType::kRate || (type == CommandType::kAngle && k < 2);
    if (closed) {
      m.angle = angles[k];
      m.rate = state.rates_rad_s[static_cast<Eigen::Index>(k)];
      output_[3 + k] = run_axis(axes_[k], type, command.value[3 + k], m);
    } else {
      axes_[k].last = type;
    }
    output_[3 + k] += config_.equilibrium_torque[k];
  }
  const float throttle_scale = config_.max_throttle * config_.max_thrust_N;
  for (std::size_t k = 0; k < 3; ++k) {
    if (command.type[k] == CommandType::kThrottle) {
      output_[k] = (k == 2 ? -1.0f : 1.0f) * command.value[k] * throttle_scale;
    }
  }
  return output_;
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
