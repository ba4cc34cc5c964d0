// SPDX-License-Identifier: BSD-3-Clause
#include <rclcpp/rclcpp.hpp>

#include "autonomy/fixedwing/path_follower.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosplane/conversions.hpp"
#include "rosplane/fixedwing_parameters.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using rosplane_msgs::msg::ControllerCommands;
using rosplane_msgs::msg::CurrentPath;
using rosplane_msgs::msg::State;

/// Course, height and airspeed for the present path, one command for a state.
///
/// Stops: without a state, a path younger than the vehicle file's follower.timeout_s or a path that
/// can be followed it publishes nothing, and the controller does what it does without commands.
class PathFollowerNode : public rclcpp::Node {
 public:
  explicit PathFollowerNode(const rclcpp::NodeOptions& options)
      : Node("path_follower", options),
        config_{FixedWingConfig::declare(*this)},
        parameters_{*this, parameters(), config_},
        reader_{config_.min_airspeed_known_m_s, config_.flight.follower.gravity_m_s2} {
    apply(config_);
    parameters_.on_change([this](const FixedWingConfig& wanted) { return apply(wanted); });
    commands_ = create_publisher<ControllerCommands>("controller_command", rclcpp::QoS(1));
    paths_ = create_subscription<CurrentPath>(
        "current_path", rclcpp::QoS(100), [this](CurrentPath::ConstSharedPtr message) {
          path_ = path_of(*message);
          received_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                         [this](State::ConstSharedPtr message) { step(*message); });
  }

 private:
  static FixedWingTable parameters() {
    using config::Range;
    using C = FixedWingConfig;
    const auto follower = [](auto member) {
      return config::at(&C::flight, &fixedwing::FlightConfig::follower, member);
    };
    using F = std::remove_cvref_t<decltype(fixedwing::FlightConfig::follower)>;
    return {{"controller_commands_pub_frequency", &C::rate_Hz, "Hz", Range::between(1.0, 1000.0),
             "maximum commands per second"},
            {"chi_infty", follower(&F::approach_rad), "rad", Range::between(0.05, 1.57),
             "course towards a line from far away"},
            {"k_path", follower(&F::line_gain_1_m), "1/m", Range::between(1e-4, 1.0),
             "gain of joining a line"},
            {"k_orbit", follower(&F::circle_gain), "", Range::between(0.1, 20.0),
             "gain of joining an orbit"},
            {"gravity", follower(&F::gravity_m_s2), "m/s^2", Range::between(9.0, 10.0), "gravity"}};
  }

  std::string apply(const FixedWingConfig& wanted) {
    follower_ = fixedwing::PathFollower(wanted.flight.follower);
    return "";
  }

  void step(const State& message) {
    const autonomy::StateEstimate& state = reader_.read(message);
    if (!received_ || !thinning_.pass(state.t_s, config_.rate_Hz)) return;
    if (!flyable(state) || state.horizontal == autonomy::Quality::kNone) return;
    const fixedwing::ControllerCommand command =
        follower_.step(state, path_, std::max(0.0, (now() - *received_).seconds()));
    if (command.valid != valid_) {
      valid_ = command.valid;
      if (valid_) {
        RCLCPP_INFO(get_logger(), "follows");
      } else {
        RCLCPP_WARN(get_logger(), "current_path is silent or cannot be followed: no commands");
      }
    }
    if (!command.valid) return;
    ControllerCommands out;
    put(command, out);
    out.header = message.header;
    commands_->publish(out);
  }

  FixedWingConfig config_;
  FixedWingParameters parameters_;
  StateReader reader_;
  fixedwing::PathFollower follower_;
  fixedwing::CurrentPath path_{};
  std::optional<rclcpp::Time> received_;
  Thinning thinning_;
  bool valid_{false};
  rclcpp::Publisher<ControllerCommands>::SharedPtr commands_;
  rclcpp::Subscription<CurrentPath>::SharedPtr paths_;
  rclcpp::Subscription<State>::SharedPtr states_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::PathFollowerNode, SingleThreadedExecutor)
