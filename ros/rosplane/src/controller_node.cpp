// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <rosplane_msgs/msg/controller_internals.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "autonomy/common/flight_events.hpp"
#include "autonomy/fixedwing/flight_manager.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosplane/controller_parameters.hpp"
#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using rosflight_msgs::msg::Command;
using rosplane_msgs::msg::ControllerCommands;
using rosplane_msgs::msg::ControllerInternals;
using rosplane_msgs::msg::FlightPhase;
using rosplane_msgs::msg::State;

/// Course, height and airspeed to surfaces and throttle, one command for a state.
///
/// With a path_manager of ours, flight_phase has what is flown; without one, altitude zones take
/// off by themselves once there is a command.
///
/// Stops:
/// - no state that can be flown on for 0.1 s: every entry of the command goes to the pilot, until
///   it is back;
/// - no valid command for the vehicle file's controller.command_timeout_s: circles (Controller);
/// - flight_phase stops: on the ground it stays there, in the air it flies its commands on.
class ControllerNode : public rclcpp::Node {
 public:
  explicit ControllerNode(const rclcpp::NodeOptions& options)
      : Node("controller", options),
        law_{declare_control_type()},
        config_{with(FixedWingConfig::declare(*this), law_)},
        parameters_{*this, controller_parameters(), config_},
        reader_{config_.min_airspeed_known_m_s, config_.flight.controller.airframe.gravity_m_s2},
        controller_{config_.flight.controller},
        zones_{config_.zones} {
    parameters_.on_change([this](const FixedWingConfig& wanted) { return apply(wanted); });
    commands_ = create_publisher<Command>("command", rclcpp::QoS(10));
    internals_ = create_publisher<ControllerInternals>("controller_internals", rclcpp::QoS(10));
    wanted_ = create_subscription<ControllerCommands>(
        "controller_command", rclcpp::QoS(10), [this](ControllerCommands::ConstSharedPtr message) {
          command_ = *message;
          last_command_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    phases_ = create_subscription<FlightPhase>(
        "flight_phase", rclcpp::QoS(10),
        [this](FlightPhase::ConstSharedPtr message) { take(*message); });
    statuses_ = create_subscription<rosflight_msgs::msg::Status>(
        "status", rclcpp::QoS(10), [this](rosflight_msgs::msg::Status::ConstSharedPtr message) {
          armed_ = message->armed;
          pilot_ = autonomy::PilotOverride::from_word(message->rc_override);
        });
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                         [this](State::ConstSharedPtr message) { step(*message); });
    watch_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(0.02),
                                  [this] { watch(); });
  }

 private:
  /// Nothing: as the vehicle file says.
  std::optional<fixedwing::LongitudinalKind> declare_control_type() {
    const auto type = declare_parameter<std::string>(
        "control_type", "vehicle",
        rosflight_common::described(
            "longitudinal law: total_energy, successive_loop, or vehicle: as in the vehicle file",
            true));
    if (type == "total_energy") return fixedwing::LongitudinalKind::kTotalEnergy;
    if (type == "successive_loop") return fixedwing::LongitudinalKind::kSuccessiveLoops;
    if (type == "vehicle" || type == "default") return {};
    throw std::invalid_argument("control type: found '" + type +
                                "', allowed total_energy, successive_loop or vehicle");
  }
  static FixedWingConfig with(FixedWingConfig config,
                              std::optional<fixedwing::LongitudinalKind> law) {
    if (law) config.flight.controller.longitudinal = *law;
    return config;
  }

  std::string apply(const FixedWingConfig& wanted) {
    controller_.configure(wanted.flight.controller);
    zones_.configure(wanted.zones);
    return "";
  }

  void take(const FlightPhase& message) {
    const bool begins =
        message.phase == FlightPhase::TAKEOFF && (!phase_ || phase_->phase != FlightPhase::TAKEOFF);
    if (begins) controller_.reset();
    phase_ = message;
    last_phase_ = rosflight_common::received_at(*this, message.header.stamp);
  }

  bool fresh(const std::optional<rclcpp::Time>& received) const {
    return received && age_s(*received) <= config_.flight.controller.command_timeout_s;
  }
  double age_s(const rclcpp::Time& received) const {
    return std::max(0.0, (now() - received).seconds());
  }

  void step(const State& message) {
    const autonomy::StateEstimate& state = reader_.read(message);
    if (!flyable(state)) return;
    last_state_ = rosflight_common::received_at(*this, message.header.stamp);
    if (lost_) RCLCPP_INFO(get_logger(), "estimated_state is back");
    lost_ = false;
    if (!thinning_.pass(state.t_s, config_.rate_Hz)) return;
    const double dt_s = state.t_s - last_s_;
    last_s_ = state.t_s;
    const auto direct = direct_command(state);
    Command out;
    out.header = message.header;
    if (direct) {
      fly(state, *direct, dt_s, out);
    } else {
      controller_.reset();
    }
    commands_->publish(out);
  }

  /// What is flown beside the command; nothing: the vehicle stays on the ground.
  std::optional<fixedwing::Controller::Direct> direct_command(
      const autonomy::StateEstimate& state) {
    if (!phase_) {
      if (!last_command_) return {};
      return zones_.step(
          {state.t_s, state, armed_, pilot_.any(), static_cast<double>(command_.h_c)},
          config_.flight);
    }
    if (phase_->idle || !armed_) return {};
    if (fresh(last_phase_)) return direct_of(*phase_);
    return fixedwing::Controller::Direct{};
  }

  void fly(const autonomy::StateEstimate& state, fixedwing::Controller::Direct direct, double dt_s,
           Command& out) {
    const bool commanded = fresh(last_command_);
    const bool taking_off = zone() == ControllerInternals::ZONE_TAKE_OFF;
    if (taking_off) {
      direct.max_throttle = std::min(direct.max_throttle, config_.max_takeoff_throttle);
    } else if (commanded) {
      if (config_.roll_override) direct.roll_rad = given(command_.phi_c);
      if (config_.pitch_override) direct.pitch_rad = given(command_.theta_c);
    }
    const fixedwing::ControllerCommand command = command_of(command_);
    const double age_s = last_command_ ? this->age_s(*last_command_) : 1e9;
    const fixedwing::Controller::Output& control =
        controller_.step({state, command, age_s, dt_s, pilot_, direct});
    if (control.lost != circling_ && !direct.roll_rad) {
      circling_ = control.lost;
      if (circling_) {
        RCLCPP_WARN(get_logger(), "controller_command is silent: circles");
      } else {
        RCLCPP_INFO(get_logger(), "flies by controller_command");
      }
    }
    if (control.aileron_lost && !rolls_by_rudder_) {
      RCLCPP_WARN(get_logger(), "%s", autonomy::name(autonomy::FlightEventType::kAileronsLost));
    }
    rolls_by_rudder_ = control.aileron_lost;
    const autonomy::FirmwareCommand command_out = fixedwing::command_of(control.surfaces);
    out.mode = static_cast<std::uint8_t>(command_out.mode);
    out.ignore = command_out.ignore;
    out.u = command_out.u;
    ControllerInternals inner;
    inner.header = out.header;
    inner.theta_c = single(control.pitch_c_rad);
    inner.phi_c = single(control.roll_c_rad);
    inner.alt_zone = zone();
    internals_->publish(inner);
  }

  std::uint8_t zone() const {
    if (!phase_) return static_cast<std::uint8_t>(zones_.zone());
    switch (phase_->phase) {
      case FlightPhase::DISARMED:
      case FlightPhase::TAKEOFF:
        return ControllerInternals::ZONE_TAKE_OFF;
      case FlightPhase::CLIMB:
        return ControllerInternals::ZONE_CLIMB;
      case FlightPhase::MISSION:
      case FlightPhase::LOITER:
      case FlightPhase::RETURN:
        return ControllerInternals::ZONE_ALTITUDE_HOLD;
      default:
        return ControllerInternals::ZONE_DESEND;
    }
  }

  /// No state: the pilot gets what he is asked for.
  void watch() {
    if (!last_state_ || age_s(*last_state_) <= fixedwing::Guidance::kStateGrace_s) return;
    if (!lost_) RCLCPP_ERROR(get_logger(), "estimated_state is silent: the pilot has control");
    lost_ = true;
    Command out;
    out.header.stamp = now();
    out.ignore = autonomy::kIgnoreAll;
    commands_->publish(out);
  }

  std::optional<fixedwing::LongitudinalKind> law_;
  FixedWingConfig config_;
  FixedWingParameters parameters_;
  StateReader reader_;
  fixedwing::Controller controller_;
  fixedwing::AltitudeZones zones_;
  ControllerCommands command_;
  std::optional<FlightPhase> phase_;
  std::optional<rclcpp::Time> last_command_, last_phase_, last_state_;
  autonomy::PilotOverride pilot_{};
  Thinning thinning_;
  double last_s_{};
  bool armed_{false};
  bool lost_{false};
  bool circling_{false};
  bool rolls_by_rudder_{false};
  rclcpp::Publisher<Command>::SharedPtr commands_;
  rclcpp::Publisher<ControllerInternals>::SharedPtr internals_;
  rclcpp::Subscription<ControllerCommands>::SharedPtr wanted_;
  rclcpp::Subscription<FlightPhase>::SharedPtr phases_;
  rclcpp::Subscription<rosflight_msgs::msg::Status>::SharedPtr statuses_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::TimerBase::SharedPtr watch_;
};

}  // namespace
}  // namespace rosplane

/// Usage: controller [vehicle|total_energy|successive_loop]: parameter control_type as a word.
extern "C" int rosflight_node_main(int argc, char** argv) {
  std::vector<char*> words(argv, argv + argc);
  std::string type = argc > 1 ? argv[1] : "--";
  std::array<std::string, 3> options{"--ros-args", "-p", "control_type:=" + type};
  if (type.rfind("--", 0) != 0) {
    words.erase(words.begin() + 1);
    for (std::string& option : options) words.push_back(option.data());
  }
  return rosflight_common::run_node<rosplane::ControllerNode>(static_cast<int>(words.size()),
                                                              words.data());
}

ROSFLIGHT_COMPONENT(rosplane::ControllerNode)
