// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <memory>
#include <rclcpp/rclcpp.hpp>

#include "controller/controller_state_machine.hpp"
#include "ekf/estimator_ros.hpp"
#include "path_follower/path_follower_ros.hpp"
#include "path_manager/path_manager_ros.hpp"

// The modules of rosplane, each as short as it can be: a start for your own.

namespace {

class OwnEstimator : public rosplane::EstimatorROS {
  void estimate(const Input& input, Output& output) override {
    check_sensors();
    output.p = input.gyro_x, output.q = input.gyro_y, output.r = input.gyro_z;
    if (input.gps_new)
      output.pn = input.gps_n, output.pe = input.gps_e, output.chi = input.gps_course;
    if (input.diff_new) output.va = std::sqrt(2.0F * std::fmax(input.diff_pres, 0.0F) / rho_);
  }
};

/// A line to the last waypoint.
class OwnPathManager : public rosplane::PathManagerROS {
  void manage(const Input& input, Output& output) override {
    output.va_d = static_cast<float>(params_.get_double("default_airspeed"));
    if (waypoints_.empty()) return;
    const Waypoint& to = waypoints_.back();
    const float north = to.w[0] - input.pn, east = to.w[1] - input.pe;
    const float length = std::fmax(std::hypot(north, east), 1.0F);
    output.r[0] = to.w[0], output.r[1] = to.w[1], output.r[2] = to.w[2];
    output.q[0] = north / length, output.q[1] = east / length;
  }
};

/// The course of the path, turned towards the line the more, the farther it is.
class OwnPathFollower : public rosplane::PathFollowerROS {
  void follow(const Input& input, Output& output) override {
    const float chi_q = std::atan2(input.q_path[1], input.q_path[0]);
    const float beside = -std::sin(chi_q) * (input.pn - input.r_path[0]) +
                         std::cos(chi_q) * (input.pe - input.r_path[1]);
    output.chi_c = chi_q - params_.get_double("chi_infty") / std::atan2(1.0, 0.0) *
                               std::atan(params_.get_double("k_path") * beside);
    output.h_c = -input.r_path[2];
    output.va_c = input.va_d;
  }
};

class OwnController : public rosplane::ControllerStateMachine {
  void take_off(const Input& /*input*/, Output& output) override { output.delta_t = 1.0F; }
  void climb(const Input& input, Output& output) override {
    output.delta_t = 0.8F;
    output.delta_a = 0.1F * (input.chi_c - input.chi);
  }
  void altitude_hold(const Input& input, Output& output) override {
    climb(input, output);
    output.delta_e = 0.01F * (input.h - input.h_c);
  }
  void take_off_exit() override { RCLCPP_INFO(get_logger(), "left the ground"); }
  void climb_exit() override {}
  void altitude_hold_exit() override {}
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::executors::SingleThreadedExecutor executor;
  const auto estimator = std::make_shared<OwnEstimator>();
  executor.add_node(estimator);
  const auto path_manager = std::make_shared<OwnPathManager>();
  executor.add_node(path_manager);
  const auto follower = std::make_shared<OwnPathFollower>();
  executor.add_node(follower);
  const auto controller = std::make_shared<OwnController>();
  executor.add_node(controller);
  RCLCPP_INFO(estimator->get_logger(), "ready: 4 nodes");
  executor.spin();
  rclcpp::shutdown();
  return 0;
}
