// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <utility>
#include <vector>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_common {

/// Subscriptions that a node has only while somebody reads what it makes of them: 400 messages a second that nobody reads would cost
/// two processes their wake-ups.
///
/// Readers are looked for ten times a second of wall time, since rclcpp 16 does not report them (rclcpp 28 has matched_callback).
class WhileRead {
 public:
  using Subscriptions = std::vector<std::shared_ptr<rclcpp::SubscriptionBase>>;
  using Subscribe = std::function<Subscriptions()>;

  using Made = std::vector<std::shared_ptr<rclcpp::PublisherBase>>;

  /// @param node  must outlive this. @param made  what is made of them. @param subscribe  makes the subscriptions, each time that
  /// readers come.
  WhileRead(rclcpp::Node& node, Made made, Subscribe subscribe)
      : node_{node}, made_{std::move(made)}, subscribe_{std::move(subscribe)} {
    static constexpr std::chrono::milliseconds kLook{100};
    timer_ = node.create_wall_timer(kLook, [this] { look(); });
  }
  WhileRead(const WhileRead&) = delete;
  WhileRead& operator=(const WhileRead&) = delete;

 private:
  void look() {
    const bool read = std::any_of(made_.begin(), made_.end(), [](const auto& publisher) {
      return publisher->get_subscription_count() > 0;
    });
    if (read && subscriptions_.empty()) subscriptions_ = subscribe_();
    if (read || subscriptions_.empty()) return;
    subscriptions_.clear();
    tell_executor(node_);
  }

  rclcpp::Node& node_;
  Made made_;
  Subscribe subscribe_;
  Subscriptions subscriptions_;
  rclcpp::TimerBase::SharedPtr timer_;
};

}  // namespace rosflight_common
