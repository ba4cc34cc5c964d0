// SPDX-License-Identifier: BSD-3-Clause
#include "path_manager/path_manager_ros.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rosflight_common/latched.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosplane {

PathManagerROS::PathManagerROS(const rclcpp::NodeOptions& options) : Node("path_manager", options) {
  params_.declare_double("R_min", 50.0);
  params_.declare_double("default_altitude", 50.0);
  params_.declare_double("default_airspeed", 15.0);
  parameter_callback_handle_ = params_.declare_rate("current_path_pub_frequency", 100.0, 1.0, due_);
  constexpr std::size_t kWaypoints = 1000;
  using Message = rosplane_msgs::msg::Waypoint;
  paths_ = create_publisher<Path>("current_path", rclcpp::QoS(10));
  inputs_ = rosflight_common::create_latched_subscription<Message>(
      *this, "waypoint_path", kWaypoints,
      [this](Message::ConstSharedPtr message) { take(*message); });
  states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                       [this](State::ConstSharedPtr message) { step(*message); });
}

void PathManagerROS::take(const rosplane_msgs::msg::Waypoint& message) {
  orbit_dir_ = 0;
  if (message.clear_wp_list) {
    waypoints_.clear();
    early_.clear();
    num_waypoints_ = idx_a_ = 0;
    temp_waypoint_ = false;
    return;
  }
  if (waypoints_.empty() && !has_state_) {
    early_.push_back(message);  // the position of the vehicle is not known yet
    return;
  }
  if (waypoints_.empty()) {
    const auto lowest = static_cast<float>(-params_.get_double("default_altitude"));
    Waypoint here;
    here.w[0] = state_.p_n, here.w[1] = state_.p_e, here.w[2] = std::min(state_.p_d, lowest);
    here.va_d = message.va_d;
    append(here);
    temp_waypoint_ = true;
  }
  Waypoint next;
  std::copy(message.w.begin(), message.w.end(), next.w);
  next.chi_d = message.chi_d;
  next.use_chi = message.use_chi;
  next.va_d = message.va_d;
  const Waypoint& before = waypoints_.back();
  const float distance_m =
      std::hypot(next.w[0] - before.w[0], next.w[1] - before.w[1], next.w[2] - before.w[2]);
  if (static_cast<double>(distance_m) < params_.get_double("R_min"))
    RCLCPP_WARN(get_logger(), "waypoint %d: found %.1f m from the one before, allowed %.1f (R_min)",
                num_waypoints_, static_cast<double>(distance_m), params_.get_double("R_min"));
  append(next);
}

void PathManagerROS::append(const Waypoint& waypoint) {
  waypoints_.push_back(waypoint);
  ++num_waypoints_;
}

void PathManagerROS::step(const State& state) {
  state_ = state;
  if (!has_state_) {
    has_state_ = true;
    for (const auto& message : early_) take(message);
    early_.clear();
  }
  if (!due_.at(rosflight_common::nanoseconds(state.header.stamp))) return;
  Input input;
  input.pn = state.p_n, input.pe = state.p_e, input.h = -state.p_d, input.chi = state.chi;
  Output output;
  manage(input, output);
  Path path;
  path.header.stamp = state.header.stamp;
  path.path_type = output.flag ? Path::LINE_PATH : Path::ORBIT_PATH;
  path.va_d = output.va_d;
  std::copy(std::begin(output.r), std::end(output.r), path.r.begin());
  std::copy(std::begin(output.q), std::end(output.q), path.q.begin());
  std::copy(std::begin(output.c), std::end(output.c), path.c.begin());
  path.rho = output.rho;
  path.lamda = output.lamda;
  paths_->publish(path);
}

}  // namespace rosplane
