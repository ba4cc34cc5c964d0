// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <rclcpp/rclcpp.hpp>
#include <rosplane_msgs/msg/current_path.hpp>
#include <rosplane_msgs/msg/state.hpp>
#include <rosplane_msgs/msg/waypoint.hpp>
#include <vector>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace rosplane {

/// Base class for a path manager of your own: node `path_manager`, in place of rosplane's (launch argument path_manager:=false).
/// The names are those of rosplane 2.0.
///
/// With `estimated_state`, at most current_path_pub_frequency times a second, it calls manage() and publishes the result on
/// `current_path`, under the stamp of the state. Messages on `waypoint_path` are appended to waypoints_. Before the first one it
/// puts the present position of the vehicle, at default_altitude or above. Compiles as C++17.
class PathManagerROS : public rclcpp::Node {
 public:
  explicit PathManagerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  struct Waypoint {
    float w[3]{};   ///< NED [m].
    float chi_d{};  ///< Course over it [rad], with use_chi.
    bool use_chi{};
    float va_d{};  ///< [m/s]
  };

  struct Input {
    float pn{}, pe{}, h{};  ///< North, east, altitude above the origin [m].
    float chi{};            ///< Course [rad].
  };

  struct Output {
    bool flag{true};      ///< A line; false: an orbit.
    float va_d{};         ///< Airspeed [m/s].
    float r[3]{};         ///< A point of the line, NED [m].
    float q[3]{};         ///< Its unit direction.
    float c[3]{};         ///< Centre of the orbit [m].
    float rho{};          ///< Its radius [m].
    std::int8_t lamda{};  ///< 1 clockwise, -1 counter-clockwise.
  };

  ParamManager params_{this};
  std::vector<Waypoint> waypoints_;
  int num_waypoints_{0};
  int idx_a_{0};               ///< Index of the waypoint passed last; 0 after the list is cleared.
  bool temp_waypoint_{false};  ///< The first waypoint is the former position of the vehicle.
  int orbit_dir_{0};

  virtual void manage(const Input& input, Output& output) = 0;

  using Path = rosplane_msgs::msg::CurrentPath;
  using State = rosplane_msgs::msg::State;

 private:
  void take(const rosplane_msgs::msg::Waypoint& message);
  void append(const Waypoint& waypoint);
  void step(const State& state);

  State state_;
  bool has_state_{false};
  std::vector<rosplane_msgs::msg::Waypoint> early_;  ///< Received before the first state.
  rosflight_common::Due due_;
  rclcpp::Publisher<Path>::SharedPtr paths_;
  rclcpp::Subscription<rosplane_msgs::msg::Waypoint>::SharedPtr inputs_;
  rclcpp::Subscription<State>::SharedPtr states_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace rosplane
