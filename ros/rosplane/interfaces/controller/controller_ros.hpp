// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosplane_msgs/msg/controller_commands.hpp>
#include <rosplane_msgs/msg/controller_internals.hpp>
#include <rosplane_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/due.hpp"

namespace rosplane {

// NOLINTNEXTLINE(readability-identifier-naming): names of rosplane 2.0
enum class AltZones : std::uint8_t { TAKE_OFF, CLIMB, ALTITUDE_HOLD };

/// Base class for a controller of your own: node `controller`, in place of rosplane's (launch argument controller:=false). The
/// names are those of rosplane 2.0; ControllerStateMachine adds the altitude zones.
///
/// From the first `controller_command` on it calls control() with `estimated_state`, at most controller_output_frequency times a
/// second, and publishes the result on `command` (pass-through: u0 throttle, u3 aileron, u4 elevator, u5 rudder) and on
/// `controller_internals`, under the stamp of the state. An output that is not finite is published as 0. Compiles as C++17.
class ControllerROS : public rclcpp::Node {
 public:
  explicit ControllerROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

  float get_phi_c() const { return wanted_ ? wanted_->phi_c : 0.0F; }
  float get_theta_c() const { return wanted_ ? wanted_->theta_c : 0.0F; }

 protected:
  struct Input {
    float Ts{};                    ///< Since the step before [s]; 0 at the first.
    float h{};                     ///< Altitude above the origin [m].
    float va{};                    ///< Airspeed [m/s].
    float phi{}, theta{}, chi{};   ///< Roll, pitch, course [rad].
    float p{}, q{}, r{};           ///< [rad/s]
    float va_c{}, h_c{}, chi_c{};  ///< Commanded airspeed [m/s], altitude [m], course [rad].
    float phi_ff{};                ///< Feed-forward roll of the path [rad].
  };

  struct Output {
    float theta_c{}, phi_c{};  ///< For controller_internals [rad].
    float delta_e{};           ///< Elevator [rad]; times pwm_rad_e in the command.
    float delta_a{};           ///< Aileron [rad]; times pwm_rad_a.
    float delta_r{};           ///< Rudder [rad]; times pwm_rad_r.
    float delta_t{};           ///< Throttle, 0 to 1.
    AltZones current_zone{AltZones::TAKE_OFF};
  };

  ParamManager params_{this};

  virtual void control(const Input& input, Output& output) = 0;

  using Command = rosflight_msgs::msg::Command;
  using Commands = rosplane_msgs::msg::ControllerCommands;
  using Internals = rosplane_msgs::msg::ControllerInternals;
  using State = rosplane_msgs::msg::State;

 private:
  void step(const State& state);
  void publish(const State& state, const Output& output);

  std::optional<Commands> wanted_;
  rosflight_common::Due due_;
  rosflight_common::StampSteps steps_;
  rclcpp::Publisher<Command>::SharedPtr commands_;
  rclcpp::Publisher<Internals>::SharedPtr internals_;
  rclcpp::Subscription<Commands>::SharedPtr inputs_;
  rclcpp::Subscription<State>::SharedPtr states_;
  ParamManager::Handle parameter_callback_handle_;
};

}  // namespace rosplane
