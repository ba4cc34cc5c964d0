// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <roscopter_msgs/msg/controller_command.hpp>
#include <roscopter_msgs/msg/state.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/status.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace roscopter {

/// Base class for a controller of your own: node `controller`, in place of roscopter's (launch argument controller:=false). The
/// names are those of roscopter 2.0; ControllerStateMachine adds take-off and hold.
///
/// For each `estimated_state` it calls manage_state with the newest `high_level_command` and `status` and publishes the result
/// on `command`, under the stamp of the state. It skips the first state and each state whose stamp is not later than the one
/// before, because they give no time step. As in roscopter 2.0 the newest command and status count however old they are.
/// Compiles as C++17.
class ControllerROS : public rclcpp::Node {
 public:
  explicit ControllerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  static double saturate(double x, double max, double min);
  /// The angle [rad] plus whole turns, within half a turn of `fixed`.
  static double wrap_within_180(double fixed, double angle_to_wrap);

 protected:
  ParamManager params{this};
  roscopter_msgs::msg::State xhat_;  ///< The newest state.

  using Command = rosflight_msgs::msg::Command;
  using ControllerCommand = roscopter_msgs::msg::ControllerCommand;
  using State = roscopter_msgs::msg::State;
  using Status = rosflight_msgs::msg::Status;

 private:
  /// @param input_cmd  the newest command; cmd_valid is false before the first.
  /// @param dt         since the state before, above 0 [s].
  virtual Command manage_state(ControllerCommand& input_cmd, Status& status_msg, double dt) = 0;
  /// A parameter has changed. Not called while parameters are declared.
  virtual void update_gains() = 0;

  void step(const State& state);

  ControllerCommand input_;
  Status status_;
  rosflight_common::StampSteps steps_;
  rclcpp::Publisher<Command>::SharedPtr commands_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Subscription<ControllerCommand>::SharedPtr inputs_;
  rclcpp::Subscription<Status>::SharedPtr statuses_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace roscopter
