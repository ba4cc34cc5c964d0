// SPDX-License-Identifier: BSD-3-Clause
#include "controller/controller_ros.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace roscopter {

ControllerROS::ControllerROS(const rclcpp::NodeOptions& options) : Node("controller", options) {
  const auto newest = rclcpp::QoS(1);
  commands_ = create_publisher<Command>("command", newest);
  inputs_ = create_subscription<ControllerCommand>(
      "high_level_command", rosflight_common::stream(),
      [this](ControllerCommand::ConstSharedPtr message) { input_ = *message; });
  statuses_ = create_subscription<Status>(
      "status", newest, [this](Status::ConstSharedPtr message) { status_ = *message; });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
                                       [this](State::ConstSharedPtr message) { step(*message); });
  parameter_callback_handle_ = params.watch([this] { update_gains(); });
}

double ControllerROS::saturate(double x, double max, double min) {
  return std::max(min, std::min(max, x));
}

double ControllerROS::wrap_within_180(double fixed, double angle_to_wrap) {
  return fixed + std::remainder(angle_to_wrap - fixed, 2.0 * rosflight::base::kPi);
}

void ControllerROS::step(const State& state) {
  xhat_ = state;
  const double dt_s = steps_.step_s(rosflight_common::nanoseconds(state.header.stamp));
  if (dt_s == 0.0) return;
  Command command = manage_state(input_, status_, dt_s);
  command.header.stamp = state.header.stamp;
  commands_->publish(command);
}

}  // namespace roscopter
