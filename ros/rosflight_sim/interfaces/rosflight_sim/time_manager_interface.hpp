// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosgraph_msgs/msg/clock.hpp>
#include <std_srvs/srv/trigger.hpp>

namespace rosflight_sim {

/// Base class for a clock of your own: node `time_manager`, in place of standalone_time_manager (launch argument
/// time_manager:=false). The names are those of ROSflight 2.x.
///
/// It calls update_time and publishes what get_seconds and get_nanoseconds return on `/clock`, every default_pub_rate_us of simulated
/// time, real_time_multiplier times as fast as the wall's. Time waits for the world: at most one message after each
/// `sim/truth_state`, once there was one; after 2 s of silence it goes on without it. Service `time_manager/toggle_pause`. Compiles
/// as C++17.
class TimeManagerInterface : public rclcpp::Node {
 public:
  explicit TimeManagerInterface(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  /// Simulated time from one message to the next.
  std::chrono::microseconds get_clock_duration_us() const;

 protected:
  using Wall = std::chrono::steady_clock;

 private:
  /// Moves time on, usually by get_clock_duration_us().
  virtual void update_time() = 0;
  virtual unsigned long int get_seconds() = 0;
  virtual unsigned int get_nanoseconds() = 0;

  void start();
  void tick();
  void publish();

  double step_us_;
  double factor_;
  bool paused_{false};
  bool follows_{false};  ///< There is a world that answers.
  bool answered_{true};  ///< It has, since time last moved.
  std::int64_t truth_ns_{-1};
  Wall::time_point moved_;
  Wall::time_point said_;
  rclcpp::Publisher<rosgraph_msgs::msg::Clock>::SharedPtr clock_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::Service<std_srvs::srv::Trigger>::SharedPtr pause_;
  rclcpp::TimerBase::SharedPtr timer_;
  OnSetParametersCallbackHandle::SharedPtr parameter_callback_handle_;
};

}  // namespace rosflight_sim
