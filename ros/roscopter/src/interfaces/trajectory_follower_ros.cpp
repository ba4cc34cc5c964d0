// SPDX-License-Identifier: BSD-3-Clause
#include "navigation/trajectory_follower_ros.hpp"

#include <algorithm>
#include <memory>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace roscopter {

using rosflight_msgs::msg::Status;
using std_srvs::srv::Trigger;

TrajectoryFollowerROS::TrajectoryFollowerROS(const rclcpp::NodeOptions& options)
    : Node("trajectory_follower", options) {
  const auto newest = rclcpp::QoS(1);
  commands_ = create_publisher<ControllerCommand>("high_level_command", newest);
  inputs_ = create_subscription<TrajectoryCommand>(
      "trajectory_command", rosflight_common::stream(),
      [this](TrajectoryCommand::ConstSharedPtr message) { input_ = *message; });
  statuses_ = create_subscription<Status>(
      "status", newest, [this](Status::ConstSharedPtr message) { firmware_status_ = *message; });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
                                       [this](State::ConstSharedPtr message) { step(*message); });
  clear_ = create_service<Trigger>(
      "trajectory_follower/clear_integrators",
      [this](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
        clear_integrators();
        response->success = true;
      });
  parameter_callback_handle_ = params.watch([this] { update_gains(); });
}

double TrajectoryFollowerROS::saturate(double x, double max, double min) {
  return std::max(min, std::min(max, x));
}

void TrajectoryFollowerROS::step(const State& state) {
  xhat_ = state;
  const double dt_s = steps_.step_s(rosflight_common::nanoseconds(state.header.stamp));
  if (!input_ || dt_s == 0.0) return;
  ControllerCommand command = manage_trajectory(*input_, dt_s);
  command.header.stamp = state.header.stamp;
  commands_->publish(command);
}

}  // namespace roscopter
