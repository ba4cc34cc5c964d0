// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <rclcpp/rclcpp.hpp>
#include <rosplane_msgs/msg/controller_commands.hpp>
#include <rosplane_msgs/msg/current_path.hpp>
#include <rosplane_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace rosplane {

// NOLINTNEXTLINE(readability-identifier-naming): names of rosplane 2.0
enum class PathType : std::uint8_t { ORBIT, LINE };

/// Base class for a path follower of your own: node `path_follower`, in place of rosplane's (launch argument
/// path_follower:=false). The names are those of rosplane 2.0.
///
/// From the first `current_path` on it calls follow() with `estimated_state`, at most controller_commands_pub_frequency times a
/// second, and publishes the result on `controller_command`, under the stamp of the state. Compiles as C++17.
class PathFollowerROS : public rclcpp::Node {
 public:
  explicit PathFollowerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  struct Input {
    PathType p_type{PathType::ORBIT};
    float va_d{};           ///< Airspeed of the path [m/s].
    float r_path[3]{};      ///< A point of the line, NED [m].
    float q_path[3]{};      ///< Unit direction of the line.
    float c_orbit[3]{};     ///< Centre of the orbit [m].
    float rho_orbit{};      ///< Radius [m].
    int lam_orbit{};        ///< 1 clockwise, -1 counter-clockwise.
    float pn{}, pe{}, h{};  ///< North, east, altitude above the origin [m].
    float va{};             ///< Airspeed [m/s].
    float chi{}, psi{};     ///< Course, heading [rad].
  };

  struct Output {
    double va_c{};    ///< [m/s]
    double h_c{};     ///< [m]
    double chi_c{};   ///< [rad]
    double phi_ff{};  ///< [rad]
  };

  ParamManager params_{this};

  virtual void follow(const Input& input, Output& output) = 0;

  using Commands = rosplane_msgs::msg::ControllerCommands;
  using Path = rosplane_msgs::msg::CurrentPath;
  using State = rosplane_msgs::msg::State;

 private:
  void take(const Path& path);
  void step(const State& state);

  Input input_;
  bool has_path_{false};
  rosflight_common::Due due_;
  rclcpp::Publisher<Commands>::SharedPtr commands_;
  rclcpp::Subscription<Path>::SharedPtr paths_;
  rclcpp::Subscription<State>::SharedPtr states_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace rosplane
