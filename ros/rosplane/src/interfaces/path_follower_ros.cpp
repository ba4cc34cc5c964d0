// SPDX-License-Identifier: BSD-3-Clause
#include "path_follower/path_follower_ros.hpp"

#include <algorithm>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosplane {

PathFollowerROS::PathFollowerROS(const rclcpp::NodeOptions& options)
    : Node("path_follower", options) {
  params_.declare_double("chi_infty", 0.5);
  params_.declare_double("k_path", 0.05);
  params_.declare_double("k_orbit", 4.0);
  params_.declare_int("update_rate", 100);
  params_.declare_double("gravity", 9.81);
  parameter_callback_handle_ =
      params_.declare_rate("controller_commands_pub_frequency", 10.0, 0.1, due_);
  commands_ = create_publisher<Commands>("controller_command", rclcpp::QoS(1));
  paths_ = create_subscription<Path>("current_path", rclcpp::QoS(100),
                                     [this](Path::ConstSharedPtr message) { take(*message); });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                       [this](State::ConstSharedPtr message) { step(*message); });
}

void PathFollowerROS::take(const Path& path) {
  has_path_ = true;
  input_.p_type = path.path_type == Path::LINE_PATH ? PathType::LINE : PathType::ORBIT;
  input_.va_d = path.va_d;
  std::copy(path.r.begin(), path.r.end(), input_.r_path);
  std::copy(path.q.begin(), path.q.end(), input_.q_path);
  std::copy(path.c.begin(), path.c.end(), input_.c_orbit);
  input_.rho_orbit = path.rho;
  input_.lam_orbit = path.lamda == Path::CLOCKWISE ? 1 : -1;
}

void PathFollowerROS::step(const State& state) {
  if (!has_path_ || !due_.at(rosflight_common::nanoseconds(state.header.stamp))) return;
  input_.pn = state.p_n, input_.pe = state.p_e, input_.h = -state.p_d;
  input_.va = state.va, input_.chi = state.chi, input_.psi = state.psi;
  Output output;
  follow(input_, output);
  Commands commands;
  commands.header.stamp = state.header.stamp;
  commands.va_c = static_cast<float>(output.va_c);
  commands.h_c = static_cast<float>(output.h_c);
  commands.chi_c = static_cast<float>(output.chi_c);
  commands.phi_ff = static_cast<float>(output.phi_ff);
  commands_->publish(commands);
}

}  // namespace rosplane
