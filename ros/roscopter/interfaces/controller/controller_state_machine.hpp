// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <std_msgs/msg/string.hpp>

#include "controller/controller_ros.hpp"

namespace roscopter {

/// Base class for a controller without its own take-off and hold: this class flies both with compute_offboard_control. The names
/// are those of roscopter 2.0. The phases:
///
/// - disarmed: a command of zeros;
/// - takeoff, once armed with a valid command: climbs at takeoff_d_vel [m/s], in mode NPOS_EPOS_DVEL_YAW, to within
///   takeoff_height_threshold [m] of takeoff_d_pos [m, down];
/// - position_hold there for takeoff_landing_pos_hold_time [s], in mode NPOS_EPOS_DPOS_YAW;
/// - offboard: flies `high_level_command` while it is valid, else position_hold at the present position.
///
/// It does not land: land by hand, or override manage_state. The phase is published on `flight_phase` (latched), as
/// roscopter's own controller does, and path_manager starts the mission in phase offboard. Compiles as C++17.
class ControllerStateMachine : public ControllerROS {
 public:
  explicit ControllerStateMachine(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 private:
  enum class Phase : std::uint8_t { kDisarmed, kTakeoff, kPositionHold, kOffboard };

  Command manage_state(ControllerCommand& input_cmd, rosflight_msgs::msg::Status& status_msg,
                       double dt) override;
  void update_gains() override {}

  /// The command to the flight controller for an input of any mode. dt is above 0 [s].
  virtual Command compute_offboard_control(ControllerCommand& input_cmd, double dt) = 0;
  /// Called for each state while disarmed.
  virtual void reset_integrators() = 0;

  void enter(Phase phase);
  void hold_here(double down_m);
  double now_s() const;

  Phase phase_{Phase::kDisarmed};
  ControllerCommand hold_;  ///< North, east and yaw of take-off or hold; down of the hold.
  double hold_start_s_{};
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr phases_;
};

}  // namespace roscopter
