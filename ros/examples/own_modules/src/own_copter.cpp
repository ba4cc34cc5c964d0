// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <memory>

#include "ekf/estimator_ros.hpp"
#include "navigation/path_manager_ros.hpp"
#include "navigation/trajectory_follower_ros.hpp"
#include "run.hpp"

// The other three modules of roscopter, each as short as possible: a start for your own.

namespace {

/// No filter: position from GNSS, rates from the gyro, altitude from the barometer.
class OwnEstimator : public roscopter::EstimatorROS {
  void estimate(const Input& input, Output& output) override {
    check_sensors();
    output.p = input.gyro_x, output.q = input.gyro_y, output.r = input.gyro_z;
    if (input.gps_new) output.pn = input.gps_n, output.pe = input.gps_e;
    if (input.baro_new)
      output.pd = -input.static_pres / (rho_ * static_cast<float>(params_.get_double("gravity")));
  }
};

/// One waypoint after the other; stays at the last.
class OwnPathManager : public roscopter::PathManagerROS {
 public:
  OwnPathManager() {
    params.declare_double("arrival_distance", 0.5);  // [m]
  }

 private:
  roscopter_msgs::msg::TrajectoryCommand manage_path() override {
    roscopter_msgs::msg::TrajectoryCommand command;
    if (waypoint_list_.empty()) {
      command.position = {xhat_.p_n, xhat_.p_e, xhat_.p_d};
      return command;
    }
    const auto distance_m = [this] {
      const auto& w = waypoint_list_[next_].w;
      return std::hypot(w[0] - xhat_.p_n, w[1] - xhat_.p_e, w[2] - xhat_.p_d);
    };
    if (distance_m() < params.get_double("arrival_distance") && next_ + 1 < waypoint_list_.size())
      ++next_;
    command.position = waypoint_list_[next_].w;
    return command;
  }

  void clear_waypoints_internally() override {
    waypoint_list_.clear();
    next_ = 0;
  }

  std::size_t next_{0};
};

/// Passes positions on to the controller.
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
  return run(argc, argv,
             {{"estimator", [] { return std::make_shared<OwnEstimator>(); }},
              {"path_manager", [] { return std::make_shared<OwnPathManager>(); }},
              {"trajectory_follower", [] { return std::make_shared<OwnFollower>(); }}});
}
