// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosflight_msgs/srv/set_sim_state.hpp>
#include <vector>

namespace rosflight_sim {

/// Base class for dynamics of your own, for example a bridge to another simulator: node `dynamics`, in place of standalone_dynamics
/// (launch argument dynamics:=false). The names are those of ROSflight 2.x.
///
/// For each message on `sim/forces_and_moments` it calls apply_forces_and_torques, compute_wind_truth and compute_truth, and publishes
/// `sim/truth_wind` and `sim/truth_state` under the stamp of the wrench: one step, one stamp. Frames: north-east-down and body axes
/// front-right-down. Service `dynamics/set_sim_state`. Compiles as C++17.
class DynamicsInterface : public rclcpp::Node {
 public:
  explicit DynamicsInterface(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  /// A change of the node's parameters; accepts it unless overridden.
  virtual rcl_interfaces::msg::SetParametersResult parameters_callback(
      const std::vector<rclcpp::Parameter>& parameters);

  OnSetParametersCallbackHandle::SharedPtr parameter_callback_handle_;

 private:
  /// Moves the world up to the stamp of the wrench [N, N m], which acts at the centre of mass in body axes, gravity not included.
  virtual void apply_forces_and_torques(const geometry_msgs::msg::WrenchStamped& msg) = 0;
  /// Position in NED [m], attitude body to NED, velocity and rates in body axes [m/s, rad/s], acceleration in body axes [m/s^2].
  virtual rosflight_msgs::msg::SimState compute_truth() = 0;
  /// Wind in NED [m/s].
  virtual geometry_msgs::msg::Vector3Stamped compute_wind_truth() = 0;
  /// @returns false if the world cannot be put there; then nothing has changed.
  virtual bool set_sim_state(const rosflight_msgs::msg::SimState state) = 0;

  void publish(const builtin_interfaces::msg::Time& stamp);

  rclcpp::Publisher<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::Publisher<geometry_msgs::msg::Vector3Stamped>::SharedPtr wind_;
  rclcpp::Subscription<geometry_msgs::msg::WrenchStamped>::SharedPtr wrenches_;
  rclcpp::Service<rosflight_msgs::srv::SetSimState>::SharedPtr set_state_;
};

}  // namespace rosflight_sim
