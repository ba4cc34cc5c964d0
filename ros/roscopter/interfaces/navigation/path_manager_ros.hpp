// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <roscopter_msgs/msg/state.hpp>
#include <roscopter_msgs/msg/trajectory_command.hpp>
#include <roscopter_msgs/msg/waypoint.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <vector>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace roscopter {

/// Base class for a path manager of your own: node `path_manager`, in place of roscopter's (launch argument path_manager:=false).
/// The names are those of roscopter 2.0.
///
/// With `estimated_state`, at most path_update_frequency times a second, it calls manage_path and publishes the result on
/// `trajectory_command`, under the stamp of the state. Messages on `waypoints` are appended to waypoint_list_; one with
/// clear_wp_list, and the service `path_manager/clear_waypoints`, call clear_waypoints_internally. Service
/// `path_manager/print_waypoints`. Compiles as C++17.
class PathManagerROS : public rclcpp::Node {
 public:
  explicit PathManagerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  ParamManager params{this};
  roscopter_msgs::msg::State xhat_;  ///< The newest state.
  std::vector<roscopter_msgs::msg::Waypoint> waypoint_list_;

  using State = roscopter_msgs::msg::State;
  using TrajectoryCommand = roscopter_msgs::msg::TrajectoryCommand;
  using Waypoint = roscopter_msgs::msg::Waypoint;
  using Trigger = std_srvs::srv::Trigger;

 private:
  /// The setpoint for xhat_.
  virtual TrajectoryCommand manage_path() = 0;
  /// Empties waypoint_list_ and what was made of it.
  virtual void clear_waypoints_internally() = 0;

  void step(const State& state);
  void print() const;

  rosflight_common::Due due_;
  rclcpp::Publisher<TrajectoryCommand>::SharedPtr commands_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Subscription<Waypoint>::SharedPtr waypoints_;
  rclcpp::Service<Trigger>::SharedPtr clear_;
  rclcpp::Service<Trigger>::SharedPtr print_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace roscopter
