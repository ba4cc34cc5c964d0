// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <rcl_interfaces/srv/set_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using rosflight_msgs::msg::Command;
using rosplane_msgs::msg::ControllerCommands;
using rosplane_msgs::msg::State;
using std_srvs::srv::Trigger;

enum Axis : std::uint8_t { kAileron, kElevator, kThrottle, kRudder };
constexpr std::size_t kAxes = 4;

/// What an axis may be driven by. The first is the autopilot; `rate` ones move a command with the
/// stick, `angle` ones are the stick times a limit, `direct` ones leave the output to the pilot.
struct AxisTable {
  const char* parameter;
  std::vector<std::string> options;
  std::uint16_t ignore;  ///< Bit of the output in Command.
};
const std::array<AxisTable, kAxes> kTable{
    AxisTable{"aileron_input", {"path_follower", "rc_course", "rc_roll_angle", "rc_aileron"}, 0x08},
    AxisTable{
        "elevator_input", {"path_follower", "rc_altitude", "rc_pitch_angle", "rc_elevator"}, 0x10},
    AxisTable{"throttle_input", {"path_follower", "rc_airspeed", "rc_throttle"}, 0x01},
    AxisTable{"rudder_input", {"yaw_damper", "rc_rudder"}, 0x20}};

std::string list_of(const std::vector<std::string>& options) {
  std::string out;
  for (std::size_t k = 0; k < options.size(); ++k) {
    out += (k == 0 ? "" : (k + 1 == options.size() ? " or " : ", ")) + options[k];
  }
  return out;
}

/// Mixes the pilot's sticks and the autopilot, axis by axis.
///
/// Sits between path_follower and controller (input_controller_command to
/// mapped_controller_command) and between controller and rosflight_io (input_command to
/// mapped_command). Stick s = (pulse - 1500)/500 of channels 0 to 2; without RC for kSilence_s, and
/// before the first, it is 0. A rate option starts at what is flown and adds s rate dt.
///
/// Stops: commands pass when they come, and only then; where a stick makes one, it stops with
/// estimated_state.
class InputMapper : public rclcpp::Node {
 public:
  explicit InputMapper(const rclcpp::NodeOptions& options) : Node("input_mapper", options) {
    for (std::size_t k = 0; k < kAxes; ++k) {
      const AxisTable& axis = kTable[k];
      modes_[k] =
          declare_parameter<std::string>(axis.parameter, axis.options[0],
                                         rosflight_common::described(list_of(axis.options), false));
      if (!allowed(axis, modes_[k]))
        throw std::invalid_argument("parameter " + refusal(axis, modes_[k]));
    }
    declare_limits();
    const std::string controller = rosflight_common::declare_text(
        *this, "controller_node", "controller", "name of the controller whose parameters are set");
    overrides_ = create_client<rcl_interfaces::srv::SetParameters>(controller + "/set_parameters");
    changes_ = rosflight_common::on_change_or_refuse(
        *this, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
    mapped_wanted_ =
        create_publisher<ControllerCommands>("mapped_controller_command", rclcpp::QoS(1));
    mapped_ = create_publisher<Command>("mapped_command", rclcpp::QoS(10));
    listen();
    offer("set_path_follower_mode",
          {"path_follower", "path_follower", "path_follower", "yaw_damper"});
    offer("set_altitude_course_airspeed_control_mode",
          {"rc_course", "rc_altitude", "rc_airspeed", "yaw_damper"});
    offer("set_angle_control_mode",
          {"rc_roll_angle", "rc_pitch_angle", "rc_throttle", "yaw_damper"});
    offer("set_rc_passthrough_mode", {"rc_aileron", "rc_elevator", "rc_throttle", "rc_rudder"});
    // The controller may come later than this node, or again.
    remind_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(0.5),
                                   [this] { set_overrides(); });
  }

 private:
  static constexpr double kSilence_s = 0.5;

  static bool allowed(const AxisTable& axis, const std::string& mode) {
    return std::find(axis.options.begin(), axis.options.end(), mode) != axis.options.end();
  }
  static std::string refusal(const AxisTable& axis, const std::string& mode) {
    return std::string(axis.parameter) + ": found '" + mode + "', allowed " + list_of(axis.options);
  }

  void declare_limits() {
    using rosflight_common::declare_number;
    declare_number(*this, "rc_roll_angle_min_max", 0.5, 0.0, 1.5, "bank at full stick [rad]", true);
    declare_number(*this, "rc_pitch_angle_min_max", 0.5, 0.0, 1.5, "pitch at full stick [rad]",
                   true);
    declare_number(*this, "rc_course_rate", 0.5, 0.0, 10.0, "course rate at full stick [rad/s]",
                   true);
    declare_number(*this, "rc_altitude_rate", 3.0, 0.0, 100.0, "climb rate at full stick [m/s]",
                   true);
    declare_number(*this, "rc_airspeed_rate", 1.0, 0.0, 100.0,
                   "change of airspeed at full stick [m/s^2]", true);
  }
  float limit(const char* name) const { return single(get_parameter(name).as_double()); }

  void listen() {
    wanted_ =
        create_subscription<ControllerCommands>("input_controller_command", rclcpp::QoS(10),
                                                [this](ControllerCommands::ConstSharedPtr message) {
                                                  base_ = *message;
                                                  if (!sticks_command())
                                                    mapped_wanted_->publish(base_);
                                                });
    commands_ = create_subscription<Command>("input_command", rclcpp::QoS(10),
                                             [this](Command::ConstSharedPtr message) {
                                               Command out = *message;
                                               for (std::size_t k = 0; k < kAxes; ++k)
                                                 if (direct(k)) out.ignore |= kTable[k].ignore;
                                               mapped_->publish(out);
                                             });
    rc_ = create_subscription<rosflight_msgs::msg::RCRaw>(
        "rc_raw", rclcpp::QoS(10), [this](rosflight_msgs::msg::RCRaw::ConstSharedPtr message) {
          for (std::size_t k = 0; k < sticks_.size(); ++k) {
            constexpr float kMiddle_us = 1500.0F;
            constexpr float kTravel_us = 500.0F;
            const float s = (static_cast<float>(message->values[k]) - kMiddle_us) / kTravel_us;
            sticks_[k] = std::clamp(s, -1.0F, 1.0F);
          }
          last_rc_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                         [this](State::ConstSharedPtr message) { step(*message); });
  }

  void offer(const char* name, const std::array<const char*, kAxes>& modes) {
    services_.push_back(
        create_service<Trigger>(std::string("input_mapper/") + name,
                                [this, modes](const std::shared_ptr<Trigger::Request>,
                                              std::shared_ptr<Trigger::Response> response) {
                                  std::vector<rclcpp::Parameter> wanted;
                                  for (std::size_t k = 0; k < kAxes; ++k)
                                    wanted.emplace_back(kTable[k].parameter, std::string(modes[k]));
                                  const auto result = set_parameters_atomically(wanted);
                                  response->success = result.successful;
                                  response->message = result.reason;
                                }));
  }

  std::string change(const std::vector<rclcpp::Parameter>& given) {
    for (const auto& p : given) {
      for (const AxisTable& axis : kTable) {
        if (p.get_name() == axis.parameter && !allowed(axis, p.as_string()))
          return refusal(axis, p.as_string());
      }
    }
    for (const auto& p : given) {
      for (std::size_t k = 0; k < kAxes; ++k) {
        if (p.get_name() == kTable[k].parameter) modes_[k] = p.as_string();
      }
    }
    moving_ = false;
    asked_.reset();
    set_overrides();
    return "";
  }

  bool direct(std::size_t axis) const { return modes_[axis] == kTable[axis].options.back(); }
  bool is(Axis axis, const char* mode) const { return modes_[axis] == mode; }
  /// Some part of the controller's command comes from a stick.
  bool sticks_command() const {
    return is(kAileron, "rc_course") || is(kAileron, "rc_roll_angle") ||
           is(kElevator, "rc_altitude") || is(kElevator, "rc_pitch_angle") ||
           is(kThrottle, "rc_airspeed");
  }
  float stick(std::size_t channel) const {
    const bool received = last_rc_ && (now() - *last_rc_).seconds() < kSilence_s;
    return received ? sticks_[channel] : 0.0F;
  }

  void step(const State& state) {
    const double t_s = rosflight_common::seconds(state.header);
    const double dt_s = t_s - last_s_;
    last_s_ = t_s;
    if (!sticks_command()) return;
    if (!moving_) {
      moving_ = true;
      held_.chi_c = state.chi;
      held_.h_c = -state.p_d;
      held_.va_c = state.va;
    }
    constexpr double kMaxStep_s = 0.5;
    const float dt = dt_s > 0.0 && dt_s < kMaxStep_s ? single(dt_s) : 0.0F;
    held_.chi_c =
        single(autonomy::wrap_angle(wide(held_.chi_c + stick(0) * limit("rc_course_rate") * dt)));
    held_.h_c += stick(1) * limit("rc_altitude_rate") * dt;
    held_.va_c += stick(2) * limit("rc_airspeed_rate") * dt;
    ControllerCommands out = base_;
    const bool course = is(kAileron, "rc_course");
    if (course) out.chi_c = held_.chi_c;
    if (course || is(kAileron, "rc_roll_angle")) out.phi_ff = 0.0F;
    out.phi_c = stick(0) * limit("rc_roll_angle_min_max");
    const bool altitude = is(kElevator, "rc_altitude");
    if (altitude) out.h_c = held_.h_c;
    if (altitude || is(kElevator, "rc_pitch_angle")) out.aux_valid = false;
    out.theta_c = stick(1) * limit("rc_pitch_angle_min_max");
    if (is(kThrottle, "rc_airspeed")) out.va_c = held_.va_c;
    if (!(out.va_c > 0.0F)) out.va_c = held_.va_c;  // no follower has spoken yet
    if (out.h_c == 0.0F) out.h_c = held_.h_c;
    out.header = state.header;
    mapped_wanted_->publish(out);
  }

  /// Angle options need the controller's overrides.
  void set_overrides() {
    const std::array<bool, 2> wanted{is(kAileron, "rc_roll_angle"),
                                     is(kElevator, "rc_pitch_angle")};
    if (asked_ == wanted || !overrides_->service_is_ready()) return;
    asked_ = wanted;
    auto request = std::make_shared<rcl_interfaces::srv::SetParameters::Request>();
    request->parameters.push_back(
        rclcpp::Parameter("roll_command_override", wanted[0]).to_parameter_msg());
    request->parameters.push_back(
        rclcpp::Parameter("pitch_command_override", wanted[1]).to_parameter_msg());
    using Future = rclcpp::Client<rcl_interfaces::srv::SetParameters>::SharedFuture;
    // NOLINTNEXTLINE(performance-unnecessary-value-param): rclcpp wants a copy
    overrides_->async_send_request(request, [this](Future answer) {
      for (const auto& result : answer.get()->results) {
        if (!result.successful)
          RCLCPP_ERROR(get_logger(), "the controller refused: %s", result.reason.c_str());
      }
    });
  }

  std::array<std::string, kAxes> modes_;
  std::array<float, 3> sticks_{};
  std::optional<rclcpp::Time> last_rc_;
  ControllerCommands base_, held_;
  bool moving_{false};
  std::optional<std::array<bool, 2>> asked_;
  double last_s_{};
  rclcpp::Client<rcl_interfaces::srv::SetParameters>::SharedPtr overrides_;
  rclcpp::Publisher<ControllerCommands>::SharedPtr mapped_wanted_;
  rclcpp::Publisher<Command>::SharedPtr mapped_;
  rclcpp::Subscription<ControllerCommands>::SharedPtr wanted_;
  rclcpp::Subscription<Command>::SharedPtr commands_;
  rclcpp::Subscription<rosflight_msgs::msg::RCRaw>::SharedPtr rc_;
  rclcpp::Subscription<State>::SharedPtr states_;
  std::vector<rclcpp::Service<Trigger>::SharedPtr> services_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
  rclcpp::TimerBase::SharedPtr remind_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::InputMapper, SingleThreadedExecutor)
