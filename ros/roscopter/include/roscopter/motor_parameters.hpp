// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/srv/param_get.hpp>
#include <string>
#include <utility>

#include "flight/vehicle/vehicle_setup.hpp"

namespace roscopter {

/// What the flight controller makes of a throttle: the parameters that decide it, asked for one after the other, for as long as
/// the node lives.
class MotorParameters {
 public:
  using Values = std::map<std::string, double>;

  static constexpr const auto& kNames = rosflight::flight::kThrustParameters;

  /// @param changed  called with all of them once all are known, and whenever one is another.
  MotorParameters(rclcpp::Node& node, std::function<void(const Values&)> changed)
      : changed_{std::move(changed)}, client_{node.create_client<ParamGet>("param_get")} {
    timer_ = node.create_wall_timer(kBetween, [this] { ask(); });
  }

  bool complete() const { return values_.size() == kNames.size(); }
  /// The first that is not known yet; for messages.
  std::string missing() const {
    for (const char* name : kNames) {
      if (values_.count(name) == 0) return name;
    }
    return "";
  }

 private:
  using ParamGet = rosflight_msgs::srv::ParamGet;
  using Wall = std::chrono::steady_clock;
  static constexpr auto kBetween = std::chrono::milliseconds(20);
  static constexpr auto kNoAnswer = std::chrono::seconds(1);

  void ask() {
    const auto now = Wall::now();
    if (asked_ && now - *asked_ < kNoAnswer) return;
    if (asked_) client_->prune_pending_requests();
    asked_.reset();
    if (!client_->service_is_ready()) return;
    const std::string name = kNames[next_];
    auto request = std::make_shared<ParamGet::Request>();
    request->name = name;
    asked_ = now;
    client_->async_send_request(std::move(request),
                                [this, name](rclcpp::Client<ParamGet>::SharedFuture answer) {
                                  asked_.reset();
                                  if (!answer.get()->exists)
                                    return;  // not received from the flight controller yet
                                  take(name, answer.get()->value);
                                });
  }

  void take(const std::string& name, double value) {
    next_ = (next_ + 1) % kNames.size();
    const auto known = values_.find(name);
    news_ = news_ || known == values_.end() || known->second != value;
    values_[name] = value;
    // After the whole round: parameters are set one after the other.
    if (next_ != 0 || !news_ || !complete()) return;
    news_ = false;
    changed_(values_);
  }

  std::function<void(const Values&)> changed_;
  rclcpp::Client<ParamGet>::SharedPtr client_;
  rclcpp::TimerBase::SharedPtr timer_;
  std::optional<Wall::time_point> asked_;
  std::size_t next_{0};
  Values values_;
  bool news_{false};
};

}  // namespace roscopter
