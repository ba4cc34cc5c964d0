// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <std_msgs/msg/string.hpp>

#include "controller/controller_ros.hpp"

namespace roscopter {

/// A controller of your own that need not know of take-off and hold: they are flown with commands of it. Names are those of roscopter
/// 2.0.
///
/// Disarmed: command of zeros. Armed with a valid command: takeoff, up at takeoff_d_vel where it stands, in mode NPOS_EPOS_DVEL_YAW, until
/// takeoff_d_pos is as near as takeoff_height_threshold; position_hold there for takeoff_landing_pos_hold_time; then offboard, the commands
/// of `high_level_command`, as long as they are valid, and position_hold where it is when they are not. There is no landing: land by hand, or
/// override manage_state. The phase is on `flight_phase` (latched), as of roscopter's own controller, so path_manager begins when the
/// commands are flown. Compiles as C++17.
class ControllerStateMachine : public ControllerROS {
 public:
  explicit ControllerStateMachine(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 private:
  enum class Phase : std::uint8_t { kDisarmed, kTakeoff, kPositionHold, kOffboard };

  Command manage_state(ControllerCommand& input_cmd, rosflight_msgs::msg::Status& status_msg,
                       double dt) override;
  void update_gains() override {}

  /// What is sent for a command of any mode; dt is above 0 [s].
  virtual Command compute_offboard_control(ControllerCommand& input_cmd, double dt) = 0;
  /// The flight has not begun: integrals are zero.
  virtual void reset_integrators() = 0;

  void enter(Phase phase);
  void hold_here(double down_m);
  double now_s() const;

  Phase phase_{Phase::kDisarmed};
  ControllerCommand place_;  ///< North, east and yaw of take-off or hold, and the hold's down.
  double held_from_s_{};
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr phases_;
};

}  // namespace roscopter
