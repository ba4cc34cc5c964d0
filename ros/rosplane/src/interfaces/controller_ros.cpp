// SPDX-License-Identifier: BSD-3-Clause
#include "controller/controller_ros.hpp"

#include <cmath>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosplane {

ControllerROS::ControllerROS(const rclcpp::NodeOptions& options) : Node("controller", options) {
  for (const char* name : {"pwm_rad_e", "pwm_rad_a", "pwm_rad_r"})
    params_.declare_double(name, 1.0);
  parameter_callback_handle_ =
      params_.declare_rate("controller_output_frequency", 100.0, 1.0, due_);
  commands_ = create_publisher<Command>("command", rclcpp::QoS(10));
  internals_ = create_publisher<Internals>("controller_internals", rclcpp::QoS(10));
  inputs_ = create_subscription<Commands>(
      "controller_command", rclcpp::QoS(10),
      [this](Commands::ConstSharedPtr message) { wanted_ = *message; });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                       [this](State::ConstSharedPtr message) { step(*message); });
}

void ControllerROS::step(const State& state) {
  const auto stamp_ns = rosflight_common::nanoseconds(state.header.stamp);
  if (!wanted_ || !due_.at(stamp_ns)) return;
  Input input;
  input.Ts = static_cast<float>(steps_.step_s(stamp_ns));
  input.h = -state.p_d;
  input.va = state.va;
  input.phi = state.phi, input.theta = state.theta, input.chi = state.chi;
  input.p = state.p, input.q = state.q, input.r = state.r;
  input.va_c = wanted_->va_c, input.h_c = wanted_->h_c;
  input.chi_c = wanted_->chi_c, input.phi_ff = wanted_->phi_ff;
  Output output;
  control(input, output);
  publish(state, output);
}

void ControllerROS::publish(const State& state, const Output& output) {
  const auto finite = [](float value) { return std::isfinite(value) ? value : 0.0F; };
  const auto scaled = [&](float delta, const char* gain) {
    return finite(delta * static_cast<float>(params_.get_double(gain)));
  };
  Command command;
  command.header.stamp = state.header.stamp;
  command.mode = Command::MODE_PASS_THROUGH;
  command.u[0] = finite(output.delta_t);
  command.u[3] = scaled(output.delta_a, "pwm_rad_a");
  command.u[4] = scaled(output.delta_e, "pwm_rad_e");
  command.u[5] = scaled(output.delta_r, "pwm_rad_r");
  commands_->publish(command);
  Internals inner;
  inner.header.stamp = state.header.stamp;
  inner.phi_c = output.phi_c;
  inner.theta_c = output.theta_c;
  switch (output.current_zone) {
    case AltZones::TAKE_OFF:
      inner.alt_zone = Internals::ZONE_TAKE_OFF;
      break;
    case AltZones::CLIMB:
      inner.alt_zone = Internals::ZONE_CLIMB;
      break;
    case AltZones::ALTITUDE_HOLD:
      inner.alt_zone = Internals::ZONE_ALTITUDE_HOLD;
      break;
  }
  internals_->publish(inner);
}

}  // namespace rosplane
