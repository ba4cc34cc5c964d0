// SPDX-License-Identifier: BSD-3-Clause
#include <rosplane_msgs/msg/controller_commands.hpp>
#include <stdexcept>

#include "rosflight_common/component.hpp"
#include "rosflight_common/signal_node.hpp"

namespace rosplane {
namespace {

using rosplane_msgs::msg::ControllerCommands;

/// A signal on one of the controller's inputs. Roll and pitch need the controller's parameters
/// roll_command_override and pitch_command_override.
class SignalGenerator final : public rosflight_common::SignalNode {
 public:
  explicit SignalGenerator(const rclcpp::NodeOptions& options) : SignalNode("", options) {
    using rosflight_common::declare_number;
    const std::string output = declare_parameter<std::string>(
        "controller_output", "roll", rosflight_common::described(kOutputs, false));
    if (!choose(output)) throw std::invalid_argument("parameter " + refusal(output));
    const auto number = [this](const char* name, double value, double max, const char* text) {
      return declare_number(*this, name, value, -max, max, text, true);
    };
    base_.va_c =
        static_cast<float>(number("default_va_c", 15.0, 100.0, "commanded airspeed [m/s]"));
    base_.h_c = static_cast<float>(number("default_h_c", 40.0, 10000.0, "commanded height [m]"));
    base_.chi_c = static_cast<float>(number("default_chi_c", 0.0, 6.3, "commanded course [rad]"));
    base_.theta_c =
        static_cast<float>(number("default_theta_c", 0.0, 1.0, "commanded pitch [rad]"));
    base_.phi_c = static_cast<float>(number("default_phi_c", 0.0, 1.5, "commanded roll [rad]"));
    commands_ = create_publisher<ControllerCommands>("controller_command", rclcpp::QoS(1));
    own_changes_ = rosflight_common::on_change_or_refuse(
        *this, [this](const std::vector<rclcpp::Parameter>& given) { return change(given); });
  }

 private:
  static constexpr const char* kOutputs = "roll, pitch, altitude, course or airspeed";

  static std::string refusal(const std::string& output) {
    return "controller_output: found '" + output + "', allowed " + kOutputs;
  }

  static float ControllerCommands::*field(const std::string& name) {
    if (name == "roll") return &ControllerCommands::phi_c;
    if (name == "pitch") return &ControllerCommands::theta_c;
    if (name == "altitude") return &ControllerCommands::h_c;
    if (name == "course") return &ControllerCommands::chi_c;
    if (name == "airspeed") return &ControllerCommands::va_c;
    return nullptr;
  }
  bool choose(const std::string& name) {
    if (field(name) == nullptr) return false;
    varied_ = field(name);
    return true;
  }

  std::string change(const std::vector<rclcpp::Parameter>& given) {
    for (const auto& p : given) {
      if (p.get_name() == "controller_output" && field(p.as_string()) == nullptr)
        return refusal(p.as_string());
    }
    for (const auto& p : given) {
      if (p.get_name() == "controller_output") choose(p.as_string());
      const auto set = [&p](const char* name, float& value) {
        if (p.get_name() == name) value = static_cast<float>(p.as_double());
      };
      set("default_va_c", base_.va_c);
      set("default_h_c", base_.h_c);
      set("default_chi_c", base_.chi_c);
      set("default_theta_c", base_.theta_c);
      set("default_phi_c", base_.phi_c);
    }
    return "";
  }

  void publish() final {
    ControllerCommands out = base_;
    out.*varied_ = static_cast<float>(signal(static_cast<double>(base_.*varied_)));
    out.header.stamp = now();
    commands_->publish(out);
  }

  ControllerCommands base_;
  float ControllerCommands::*varied_{&ControllerCommands::phi_c};
  rclcpp::Publisher<ControllerCommands>::SharedPtr commands_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr own_changes_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::SignalGenerator, SingleThreadedExecutor)
