// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/srv/param_get.hpp>
#include <string>
#include <utility>
#include <vector>

namespace rosflight_common {

/// Parameters of the flight controller, read one after the other from rosflight_io in the background. Compiles as C++17.
class FirmwareParameters {
 public:
  using Values = std::map<std::string, double>;
  enum class Repeat { kForever, kOnRequest };

  /// @param names    at least one.
  /// @param period   between two requests, in wall time.
  /// @param repeat   kForever: round after round; `changed` is called after the first and after each in which a value changed.
  ///                 kOnRequest: one round now and one after each read_again(); `changed` is called after each.
  /// @param changed  takes all values.
  FirmwareParameters(rclcpp::Node& node, std::vector<std::string> names,
                     std::chrono::milliseconds period, Repeat repeat,
                     std::function<void(const Values&)> changed)
      : names_{std::move(names)},
        repeat_{repeat},
        changed_{std::move(changed)},
        client_{node.create_client<ParamGet>("param_get")},
        timer_{node.create_wall_timer(period, [this] { request(); })} {}
  FirmwareParameters(const FirmwareParameters&) = delete;
  FirmwareParameters& operator=(const FirmwareParameters&) = delete;

  bool complete() const { return values_.size() == names_.size(); }

  /// The first name without a value; empty if there is none.
  std::string missing() const {
    for (const std::string& name : names_) {
      if (values_.count(name) == 0) return name;
    }
    return "";
  }

  /// Reads all of them again, from the first.
  void read_again() {
    next_ = 0;
    timer_->reset();
  }

 private:
  using ParamGet = rosflight_msgs::srv::ParamGet;
  using Wall = std::chrono::steady_clock;

  void request() {
    constexpr auto kTimeout = std::chrono::seconds(1);
    const auto now = Wall::now();
    if (requested_ && now - *requested_ < kTimeout) return;
    if (requested_) client_->prune_pending_requests();
    requested_.reset();
    if (!client_->service_is_ready()) return;
    auto request = std::make_shared<ParamGet::Request>();
    request->name = names_[next_];
    requested_ = now;
    client_->async_send_request(
        std::move(request),
        [this, name = names_[next_]](rclcpp::Client<ParamGet>::SharedFuture answer) {
          requested_.reset();
          // Otherwise rosflight_io has not received it from the flight controller yet.
          if (answer.get()->exists && name == names_[next_]) store(name, answer.get()->value);
        });
  }

  void store(const std::string& name, double value) {
    next_ = (next_ + 1) % names_.size();
    const auto known = values_.find(name);
    news_ = news_ || known == values_.end() || known->second != value;
    values_[name] = value;
    if (next_ != 0) return;
    // After the whole round: parameters are set one after the other.
    const bool once = repeat_ == Repeat::kOnRequest;
    if (once) timer_->cancel();
    if (std::exchange(news_, false) || once) changed_(values_);
  }

  std::vector<std::string> names_;
  Repeat repeat_;
  std::function<void(const Values&)> changed_;
  rclcpp::Client<ParamGet>::SharedPtr client_;
  std::optional<Wall::time_point> requested_;
  std::size_t next_{0};
  Values values_;
  bool news_{false};
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace rosflight_common
