// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <string>
#include <utility>

#include "autonomy/multirotor/state_machine.hpp"
#include "rosflight_common/latched.hpp"

namespace roscopter {

/// The phases that other nodes look for; autonomy::multirotor::name() of Phase.
inline constexpr const char* kTakeoff = "takeoff";
inline constexpr const char* kPositionHold = "position_hold";
inline constexpr const char* kOffboard = "offboard";
inline constexpr const char* kLanding = "landing";

/// What the controller publishes of its state machine on `flight_phase` (latched). roscopter has no
/// such topic: where nobody publishes it, the commands of the chain are taken to be flown at all
/// times.
class FlightPhase {
 public:
  using Entered = std::function<void(const std::string&)>;

  FlightPhase(rclcpp::Node& node, Entered entered) : node_{node}, entered_{std::move(entered)} {
    phases_ = rosflight_common::create_latched_subscription<std_msgs::msg::String>(
        node, "flight_phase", 1, [this](std_msgs::msg::String::ConstSharedPtr message) {
          if (message->data == phase_) return;
          phase_ = message->data;
          entered_(phase_);
        });
  }

  /// The commands of the chain are what is flown.
  bool following() {
    if (phase_.empty()) return node_.count_publishers(phases_->get_topic_name()) == 0;
    return phase_ == kOffboard;
  }

  /// After the take-off and not yet on the ground; false where nobody publishes a phase.
  bool flying() const { return phase_ == kPositionHold || phase_ == kOffboard || landing(); }
  bool landing() const { return phase_ == kLanding; }

 private:
  rclcpp::Node& node_;
  Entered entered_;
  std::string phase_;
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr phases_;
};

}  // namespace roscopter
