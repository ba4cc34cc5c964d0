// SPDX-License-Identifier: BSD-3-Clause
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_sim/joystick.hpp"
#include "rosflight_sim/keyboard.hpp"

namespace rosflight_sim {
namespace {

using namespace rosflight_common;

using std_srvs::srv::Trigger;

/// The pilot and his transmitter: a known joystick if one is plugged in; else the keyboard if asked
/// for and there is a terminal; else the two services, which the keyboard has as well.
///
/// A joystick that is pulled out falls silent, as a transmitter out of range does.
class RcNode : public rclcpp::Node {
 public:
  explicit RcNode(const rclcpp::NodeOptions& options)
      : Node("rc", options),
        sticks_{declare_number(
            *this, "key_deflection", 0.4, 0.05, 1.0,
            "deflection of the attitude sticks by a key, as a share of the maximum")} {
    const bool use_keyboard = declare_switch(*this, "use_vimfly", false, "flies with the keyboard");
    const auto device =
        declare_integer(*this, "joystick", 0, 0, 15, "index of the joystick in the order of SDL");
    choose(static_cast<int>(device), use_keyboard);
    publisher_ = create_publisher<rosflight_msgs::msg::RCRaw>(
        "sim/RC", rclcpp::QoS(rclcpp::KeepLast(10)).reliable());
    if (!joystick_) offer_services();
    constexpr double kRate_Hz = 50.0;
    constexpr double kKeyboardRate_Hz = 30.0;
    const double rate_Hz = terminal_ ? kKeyboardRate_Hz : kRate_Hz;
    timer_ = rclcpp::create_timer(
        this, get_clock(),
        rclcpp::Duration(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rate_Hz))),
        [this] { send(); });
  }

 private:
  void choose(int device, bool use_keyboard) {
    auto joystick = Joystick::open(device);
    if (joystick) {
      map_ = find_joystick_map(joystick->name());
      if (map_ != nullptr) {
        RCLCPP_INFO(get_logger(), "joystick %s", joystick->name().c_str());
        joystick_ = std::move(joystick);
        return;
      }
      RCLCPP_WARN(get_logger(), "unknown joystick %s, not used", joystick->name().c_str());
    }
    if (!use_keyboard) return;
    auto terminal = Terminal::open();
    if (!terminal) {
      RCLCPP_WARN(get_logger(), "no terminal for the keyboard: use toggle_arm, toggle_override");
      return;
    }
    terminal_.emplace(std::move(*terminal));
    RCLCPP_INFO(get_logger(),
                "keys: h l roll, k j pitch, d f yaw, a s throttle, t arm, r override, m mode");
  }

  void offer_services() {
    arm_ =
        create_service<Trigger>("toggle_arm", [this](const std::shared_ptr<Trigger::Request>,
                                                     std::shared_ptr<Trigger::Response> response) {
          sticks_.flip_arm();
          answer(*response, "arm", kArmChannel);
        });
    override_ = create_service<Trigger>("toggle_override",
                                        [this](const std::shared_ptr<Trigger::Request>,
                                               std::shared_ptr<Trigger::Response> response) {
                                          sticks_.flip_override();
                                          answer(*response, "override", kOverrideChannel);
                                        });
  }

  void answer(Trigger::Response& response, const char* what, std::size_t channel) {
    constexpr std::uint16_t kMiddle_us = 1500;
    response.success = true;
    response.message =
        std::string(what) + (sticks_.pulses(wall())[channel] > kMiddle_us ? " on" : " off");
  }

  static KeyboardSticks::Time wall() {
    return std::chrono::duration_cast<KeyboardSticks::Time>(
        std::chrono::steady_clock::now().time_since_epoch());
  }

  void send() {
    rosflight_msgs::msg::RCRaw message;
    if (joystick_) {
      if (!joystick_->poll()) {
        constexpr int kInterval_ms = 2000;
        RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms, "the joystick has gone");
        return;
      }
      message.values = map_->pulses(joystick_->state());
    } else {
      if (terminal_)
        while (const auto key = terminal_->key()) sticks_.stroke(*key, wall());
      message.values = sticks_.pulses(wall());
      if (!terminal_)
        message.values[kModeChannel] = 1500;  // as in ROSflight 2.x: a switch in the middle
    }
    message.header.stamp = now();
    publisher_->publish(message);
  }

  static constexpr std::size_t kArmChannel = 4;
  static constexpr std::size_t kOverrideChannel = 5;
  static constexpr std::size_t kModeChannel = 6;

  std::optional<Joystick> joystick_;
  const JoystickMap* map_{nullptr};
  std::optional<Terminal> terminal_;
  KeyboardSticks sticks_;
  rclcpp::Publisher<rosflight_msgs::msg::RCRaw>::SharedPtr publisher_;
  rclcpp::Service<Trigger>::SharedPtr arm_;
  rclcpp::Service<Trigger>::SharedPtr override_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::RcNode, SingleThreadedExecutor)
