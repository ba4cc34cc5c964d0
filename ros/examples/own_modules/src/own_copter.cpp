// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "ekf/estimator_ros.hpp"
#include "navigation/path_manager_ros.hpp"
#include "navigation/trajectory_follower_ros.hpp"

// The other three modules of roscopter, each as short as it can be: a start for your own.

namespace {

/// The sensors as they are: GNSS for the place, the gyro for the rates, the barometer for the height.
class OwnEstimator : public roscopter::EstimatorROS {
  void estimate(const Input& input, Output& output) override {
    check_sensors();
    output.p = input.gyro_x, output.q = input.gyro_y, output.r = input.gyro_z;
    if (input.gps_new) output.pn = input.gps_n, output.pe = input.gps_e;
    if (input.baro_new)
      output.pd = -input.static_pres / (rho_ * static_cast<float>(params_.get_double("gravity")));
  }
};

/// The last waypoint, at once.
class OwnPathManager : public roscopter::PathManagerROS {
  roscopter_msgs::msg::TrajectoryCommand manage_path() override {
    roscopter_msgs::msg::TrajectoryCommand command;
    if (waypoint_list_.empty()) {
      command.position = {xhat_.p_n, xhat_.p_e, xhat_.p_d};
    } else {
      command.position = waypoint_list_.back().w;
    }
    return command;
  }
  void clear_waypoints_internally() override { waypoint_list_.clear(); }
};

/// Hands places on to the controller.
class OwnFollower : public roscopter::TrajectoryFollowerROS {
 public:
  OwnFollower() {
    params.declare_double("lead", 0.0);  // [s]
  }

 private:
  roscopter_msgs::msg::ControllerCommand manage_trajectory(
      roscopter_msgs::msg::TrajectoryCommand input, double /*dt*/) override {
    using roscopter_msgs::msg::ControllerCommand;
    const auto lead = static_cast<float>(params.get_double("lead"));
    ControllerCommand command;
    command.mode = ControllerCommand::MODE_NPOS_EPOS_DPOS_YAW;
    command.cmd1 = input.position[0] + lead * input.velocity[0];
    command.cmd2 = input.position[1] + lead * input.velocity[1];
    command.cmd3 = input.position[2] + lead * input.velocity[2];
    command.cmd4 = input.psi;
    command.cmd_valid = !firmware_status_.failsafe;
    return command;
  }
  void update_gains() override { RCLCPP_INFO(get_logger(), "lead %g", params.get_double("lead")); }
  void clear_integrators() override {}
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::executors::SingleThreadedExecutor executor;
  const auto estimator = std::make_shared<OwnEstimator>();
  executor.add_node(estimator);
  const auto path_manager = std::make_shared<OwnPathManager>();
  executor.add_node(path_manager);
  const auto follower = std::make_shared<OwnFollower>();
  executor.add_node(follower);
  RCLCPP_INFO(estimator->get_logger(), "ready: 3 nodes");
  executor.spin();
  rclcpp::shutdown();
  return 0;
}
