// SPDX-License-Identifier: BSD-3-Clause
#include "navigation/path_manager_ros.hpp"

#include <cstddef>
#include <memory>
#include <string>

#include "rosflight_common/latched.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace roscopter {

PathManagerROS::PathManagerROS(const rclcpp::NodeOptions& options) : Node("path_manager", options) {
  constexpr std::size_t kWaypoints = 1000;
  commands_ = create_publisher<TrajectoryCommand>("trajectory_command", rclcpp::QoS(1));
  waypoints_ = rosflight_common::create_latched_subscription<Waypoint>(
      *this, "waypoints", kWaypoints, [this](Waypoint::ConstSharedPtr message) {
        if (message->clear_wp_list)
          clear_waypoints_internally();
        else
          waypoint_list_.push_back(*message);
      });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
                                       [this](State::ConstSharedPtr message) { step(*message); });
  clear_ = create_service<Trigger>(
      "path_manager/clear_waypoints",
      [this](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
        clear_waypoints_internally();
        response->success = true;
        response->message = "all waypoints removed";
      });
  print_ = create_service<Trigger>(
      "path_manager/print_waypoints",
      [this](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
        print();
        response->success = true;
        response->message = std::to_string(waypoint_list_.size()) + " waypoints";
      });
  parameter_callback_handle_ = params.declare_rate("path_update_frequency", 50.0, 1.0, due_);
}

void PathManagerROS::step(const State& state) {
  xhat_ = state;
  if (!due_.at(rosflight_common::nanoseconds(state.header.stamp))) return;
  TrajectoryCommand command = manage_path();
  command.header.stamp = state.header.stamp;
  commands_->publish(command);
}

void PathManagerROS::print() const {
  for (const Waypoint& waypoint : waypoint_list_) {
    RCLCPP_INFO(get_logger(), "%s %g, %g, %g (%s), heading %g rad, speed %g m/s",
                waypoint.type == Waypoint::TYPE_GOTO ? "goto" : "hold",
                static_cast<double>(waypoint.w[0]), static_cast<double>(waypoint.w[1]),
                static_cast<double>(waypoint.w[2]),
                waypoint.use_lla ? "latitude, longitude, altitude" : "north, east, down",
                static_cast<double>(waypoint.psi), static_cast<double>(waypoint.speed));
  }
}

}  // namespace roscopter
