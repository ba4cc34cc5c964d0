// SPDX-License-Identifier: BSD-3-Clause
#include "controller/controller_state_machine.hpp"

#include <array>
#include <cmath>
#include <cstddef>

#include "rosflight_common/latched.hpp"
#include "rosflight_common/time.hpp"

namespace roscopter {

ControllerStateMachine::ControllerStateMachine(const rclcpp::NodeOptions& options)
    : ControllerROS(options) {
  params.declare_double("takeoff_d_pos", -10.0);
  params.declare_double("takeoff_height_threshold", 1.0);
  params.declare_double("takeoff_d_vel", -0.5);
  params.declare_double("takeoff_landing_pos_hold_time", 3.0);
  phases_ =
      rosflight_common::create_latched_publisher<std_msgs::msg::String>(*this, "flight_phase", 1);
  enter(Phase::kDisarmed);
}

double ControllerStateMachine::now_s() const {
  return rosflight_common::seconds(xhat_.header);
}

void ControllerStateMachine::enter(Phase phase) {
  constexpr std::array<const char*, 4> kNames{"disarmed", "takeoff", "position_hold", "offboard"};
  phase_ = phase;
  std_msgs::msg::String name;
  name.data = kNames[static_cast<std::size_t>(phase)];
  RCLCPP_INFO(get_logger(), "%s", name.data.c_str());
  phases_->publish(name);
}

void ControllerStateMachine::hold_here(double down_m) {
  hold_.cmd1 = xhat_.p_n;
  hold_.cmd2 = xhat_.p_e;
  hold_.cmd3 = static_cast<float>(down_m);
  hold_.cmd4 = xhat_.psi;
  hold_.cmd_valid = true;
}

rosflight_msgs::msg::Command ControllerStateMachine::manage_state(
    ControllerCommand& input_cmd, rosflight_msgs::msg::Status& status_msg, double dt) {
  if (!status_msg.armed && phase_ != Phase::kDisarmed) enter(Phase::kDisarmed);
  if (phase_ == Phase::kDisarmed) {
    reset_integrators();
    if (!status_msg.armed || !input_cmd.cmd_valid) return Command();
    hold_here(params.get_double("takeoff_d_pos"));
    enter(Phase::kTakeoff);
  }
  if (phase_ == Phase::kOffboard) {
    if (input_cmd.cmd_valid) return compute_offboard_control(input_cmd, dt);
    hold_here(static_cast<double>(xhat_.p_d));
    hold_start_s_ = now_s();
    enter(Phase::kPositionHold);
  }
  if (phase_ == Phase::kTakeoff &&
      std::abs(static_cast<double>(xhat_.p_d) - params.get_double("takeoff_d_pos")) <=
          params.get_double("takeoff_height_threshold")) {
    hold_start_s_ = now_s();
    enter(Phase::kPositionHold);
  }
  ControllerCommand own = hold_;
  own.mode = ControllerCommand::MODE_NPOS_EPOS_DPOS_YAW;
  if (phase_ == Phase::kTakeoff) {
    own.mode = ControllerCommand::MODE_NPOS_EPOS_DVEL_YAW;
    own.cmd3 = static_cast<float>(params.get_double("takeoff_d_vel"));
  } else if (input_cmd.cmd_valid &&
             now_s() - hold_start_s_ >= params.get_double("takeoff_landing_pos_hold_time")) {
    enter(Phase::kOffboard);
    return compute_offboard_control(input_cmd, dt);
  }
  return compute_offboard_control(own, dt);
}

}  // namespace roscopter
