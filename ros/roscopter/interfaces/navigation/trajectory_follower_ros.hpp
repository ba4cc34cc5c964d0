// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <roscopter_msgs/msg/controller_command.hpp>
#include <roscopter_msgs/msg/state.hpp>
#include <roscopter_msgs/msg/trajectory_command.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace roscopter {

/// Base class for a trajectory follower of your own: node `trajectory_follower`, in place of roscopter's (launch argument
/// trajectory_follower:=false). The names are those of roscopter 2.0.
///
/// From the first `trajectory_command` on it calls manage_trajectory for each `estimated_state` with a later stamp than the one
/// before, and publishes the result on `high_level_command`, under the stamp of the state. Service
/// `trajectory_follower/clear_integrators`. Compiles as C++17.
class TrajectoryFollowerROS : public rclcpp::Node {
 public:
  explicit TrajectoryFollowerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  static double saturate(double x, double max, double min);

 protected:
  ParamManager params{this};
  roscopter_msgs::msg::State xhat_;              ///< The newest state.
  rosflight_msgs::msg::Status firmware_status_;  ///< The newest status.

  using ControllerCommand = roscopter_msgs::msg::ControllerCommand;
  using State = roscopter_msgs::msg::State;
  using TrajectoryCommand = roscopter_msgs::msg::TrajectoryCommand;

 private:
  /// @param dt  since the state before, above 0 [s].
  virtual ControllerCommand manage_trajectory(TrajectoryCommand input_cmd, double dt) = 0;
  /// A parameter has changed. Not called while parameters are declared.
  virtual void update_gains() = 0;
  virtual void clear_integrators() = 0;

  void step(const State& state);

  std::optional<TrajectoryCommand> input_;
  rosflight_common::StampSteps steps_;
  rclcpp::Publisher<ControllerCommand>::SharedPtr commands_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Subscription<TrajectoryCommand>::SharedPtr inputs_;
  rclcpp::Subscription<rosflight_msgs::msg::Status>::SharedPtr statuses_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr clear_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace roscopter
