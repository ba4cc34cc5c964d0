// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/time_manager_interface.hpp"

#include <cstdint>
#include <memory>
#include <utility>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/time_parameters.hpp"

namespace rosflight_sim {

using std_srvs::srv::Trigger;

TimeManagerInterface::TimeManagerInterface(const rclcpp::NodeOptions& options)
    : Node("time_manager", options),
      step_us_{declare_step_us(*this)},
      factor_{declare_factor(*this)} {
  clock_ = create_publisher<rosgraph_msgs::msg::Clock>(
      "/clock", rclcpp::QoS(rclcpp::KeepLast(1)).best_effort());
  truth_ = create_subscription<rosflight_msgs::msg::SimState>(
      "sim/truth_state", rosflight_common::newest(),
      [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) {
        // One that is sent again, because its step was, is no answer to a newer step.
        const std::int64_t stamp_ns = rosflight_common::nanoseconds(message->header.stamp);
        if (std::exchange(truth_ns_, stamp_ns) != stamp_ns) follows_ = answered_ = true;
      });
  pause_ = create_service<Trigger>(
      "time_manager/toggle_pause",
      [this](const std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
        paused_ = !paused_;
        response->success = true;
        response->message = paused_ ? "paused" : "running";
      });
  parameter_callback_handle_ =
      rosflight_common::on_change(*this, [this](const rclcpp::Parameter& parameter) {
        if (parameter.get_name() == kStepParameter) step_us_ = parameter.as_double();
        if (parameter.get_name() == kFactorParameter) factor_ = parameter.as_double();
        start();
      });
  start();
}

std::chrono::microseconds TimeManagerInterface::get_clock_duration_us() const {
  return std::chrono::microseconds(static_cast<std::int64_t>(step_us_));
}

void TimeManagerInterface::start() {
  timer_.reset();
  moved_ = said_ = Wall::now();
  timer_ = create_wall_timer(
      std::chrono::nanoseconds(static_cast<std::int64_t>(step_us_ * 1e3 / factor_)),
      [this] { tick(); });
}

void TimeManagerInterface::tick() {
  constexpr auto kGiveUp = std::chrono::seconds(2);
  constexpr auto kSayAgain = std::chrono::milliseconds(20);
  const auto now = Wall::now();
  if (!paused_ && follows_ && !answered_ && now - moved_ > kGiveUp) {
    follows_ = false;
    RCLCPP_WARN(get_logger(), "no sim/truth_state for %ld s: time goes on without it",
                static_cast<long>(kGiveUp.count()));
  }
  if (!paused_ && (answered_ || !follows_)) {
    answered_ = false;
    moved_ = now;
    update_time();
    publish();
  } else if (now - said_ > kSayAgain) {  // best effort: it may have been lost, or a node came late
    publish();
  }
}

void TimeManagerInterface::publish() {
  rosgraph_msgs::msg::Clock message;
  message.clock.sec = static_cast<std::int32_t>(get_seconds());
  message.clock.nanosec = get_nanoseconds();
  clock_->publish(message);
  said_ = Wall::now();
}

}  // namespace rosflight_sim
