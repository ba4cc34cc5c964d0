// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <roscopter_msgs/msg/controller_command.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/signal_node.hpp"

namespace roscopter {
namespace {

using roscopter_msgs::msg::ControllerCommand;

/// A waveform on one of the four numbers of a command of any mode. Its commands are always valid,
/// so an armed vehicle takes off on them.
class SignalGenerator final : public rosflight_common::SignalNode {
 public:
  explicit SignalGenerator(const rclcpp::NodeOptions& options)
      : SignalNode("signal_generator/", options) {
    mode_ = rosflight_common::declare_integer(*this, "controller_mode", 0, 0, 11,
                                              "mode of roscopter_msgs/ControllerCommand", true);
    output_ = rosflight_common::declare_integer(*this, "controller_output", 1, 1, 4,
                                                "number of the cmd that varies", true);
    for (std::size_t k = 0; k < base_.size(); ++k) {
      base_[k] = rosflight_common::declare_number(
          *this, "default_cmd" + std::to_string(k + 1), 0.0, -10'000.0, 10'000.0,
          "value of this cmd; lower end of the one that varies", true);
    }
    commands_ = create_publisher<ControllerCommand>("high_level_command", rclcpp::QoS(1));
    changes_ = rosflight_common::on_change(*this, [this](const rclcpp::Parameter& p) { take(p); });
  }

 private:
  void take(const rclcpp::Parameter& p) {
    if (p.get_name() == "controller_mode") mode_ = p.as_int();
    if (p.get_name() == "controller_output") output_ = p.as_int();
    for (std::size_t k = 0; k < base_.size(); ++k) {
      if (p.get_name() == "default_cmd" + std::to_string(k + 1)) base_[k] = p.as_double();
    }
  }

  void publish() final {
    std::array<double, 4> cmd = base_;
    double& varied = cmd[static_cast<std::size_t>(output_ - 1)];
    varied = signal(varied);
    ControllerCommand out;
    out.header.stamp = now();
    out.mode = static_cast<std::uint8_t>(mode_);
    out.cmd1 = static_cast<float>(cmd[0]);
    out.cmd2 = static_cast<float>(cmd[1]);
    out.cmd3 = static_cast<float>(cmd[2]);
    out.cmd4 = static_cast<float>(cmd[3]);
    out.cmd_valid = true;
    commands_->publish(out);
  }

  std::int64_t mode_{};
  std::int64_t output_{1};
  std::array<double, 4> base_{};
  rclcpp::Publisher<ControllerCommand>::SharedPtr commands_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr changes_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::SignalGenerator, SingleThreadedExecutor)
