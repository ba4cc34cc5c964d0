// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/dynamics_interface.hpp"

#include <memory>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_sim {

using rosflight_common::newest;
using rosflight_msgs::srv::SetSimState;

DynamicsInterface::DynamicsInterface(const rclcpp::NodeOptions& options)
    : Node("dynamics", options) {
  parameter_callback_handle_ =
      add_on_set_parameters_callback([this](const std::vector<rclcpp::Parameter>& parameters) {
        return parameters_callback(parameters);
      });
  truth_ = create_publisher<rosflight_msgs::msg::SimState>("sim/truth_state", newest());
  wind_ = create_publisher<geometry_msgs::msg::Vector3Stamped>("sim/truth_wind", newest());
  set_state_ = create_service<SetSimState>(
      "dynamics/set_sim_state", [this](const std::shared_ptr<SetSimState::Request> request,
                                       std::shared_ptr<SetSimState::Response> response) {
        response->success = set_sim_state(request->state);
        response->message = response->success ? "set" : "found a state that the world cannot be in";
        if (response->success) publish(now());
      });
  wrenches_ = create_subscription<geometry_msgs::msg::WrenchStamped>(
      "sim/forces_and_moments", newest(),
      [this](geometry_msgs::msg::WrenchStamped::ConstSharedPtr message) {
        apply_forces_and_torques(*message);
        publish(message->header.stamp);
      });
}

rcl_interfaces::msg::SetParametersResult DynamicsInterface::parameters_callback(
    const std::vector<rclcpp::Parameter>& /*parameters*/) {
  rcl_interfaces::msg::SetParametersResult result;
  result.successful = true;
  return result;
}

void DynamicsInterface::publish(const builtin_interfaces::msg::Time& stamp) {
  auto wind = compute_wind_truth();
  wind.header.stamp = stamp;
  wind.header.frame_id = "NED";
  wind_->publish(wind);
  auto truth = compute_truth();
  truth.header.stamp = stamp;
  truth.header.frame_id = "NED";
  truth_->publish(truth);
}

}  // namespace rosflight_sim
