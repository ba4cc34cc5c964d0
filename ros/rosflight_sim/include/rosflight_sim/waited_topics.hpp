// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_sim {

/// How long something is overdue, in wall time that this program had: two looks count as kLongestGap apart at most, so a
/// machine that stood still gives nobody up.
class Overdue {
 public:
  using Wall = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kGiveUp{2};

  void none() { sum_ = {}, last_.reset(); }
  /// Whether it has been overdue at looks for `limit` together since none().
  bool give_up(Wall::time_point now, Wall::duration limit = kGiveUp) {
    if (last_) sum_ += std::min<Wall::duration>(now - *last_, kLongestGap);
    last_ = now;
    return sum_ >= limit;
  }

 private:
  static constexpr auto kLongestGap = std::chrono::milliseconds(50);
  Wall::duration sum_{};
  std::optional<Wall::time_point> last_;
};

/// Topics that simulated time must not leave behind: who publishes them has dealt with the world up to their stamps.
///
/// Any type whose first field is a std_msgs/Header. A topic counts when kFirst intervals between its messages are known. One
/// that is Overdue for too long counts no more, until that is so again.
class WaitedTopics {
 public:
  using Wall = Overdue::Wall;

  /// @param names    separated by spaces, as a node's topics are named. @param on_message  called after each
  /// message.
  WaitedTopics(rclcpp::Node& node, const std::string& names, std::function<void()> on_message)
      : node_{node}, on_message_{std::move(on_message)} {
    std::istringstream each(names);
    for (std::string name; each >> name;) {
      const std::string space = node.get_namespace();
      if (name.front() != '/') name = (space == "/" ? "" : space) + "/" + name;
      topics_.push_back({name, nullptr, {}, 0, 0, {}, false});
    }
    if (topics_.empty()) return;
    finder_ = node.create_wall_timer(std::chrono::milliseconds(100), [this] { find(); });
  }

  /// Whether the next message of a topic that counts is overdue by more than `lag_ns` at `time_ns`: it is expected as long
  /// after the last as messages of late were apart. Tells once of each that counts no more.
  bool behind(std::int64_t time_ns, std::int64_t lag_ns, Wall::time_point now) {
    bool any = false;
    for (Topic& topic : topics_) {
      if (!topic.counts || time_ns - *topic.stamp_ns - topic.period_ns <= lag_ns) continue;
      topic.counts = !topic.overdue.give_up(now);
      any = any || topic.counts;
      if (topic.counts) continue;
      topic.intervals = 0;
      topic.stamp_ns.reset();
      RCLCPP_WARN(node_.get_logger(), "no %s for %ld s: time goes on without it",
                  topic.name.c_str(), static_cast<long>(Overdue::kGiveUp.count()));
    }
    return any;
  }

 private:
  static constexpr std::int64_t kLongestPeriod_ns = 250'000'000;
  static constexpr int kFirst = 4;  ///< The first may be short: a timer that was late catches up.
  static constexpr std::int64_t kGrowing = 16;
  static constexpr std::int64_t kForgetting = 64;
  static constexpr std::size_t kDepth =
      50;  // a message that is not read makes its topic seem half as frequent

  struct Topic {
    std::string name;
    std::shared_ptr<rclcpp::SubscriptionBase> subscription;
    std::optional<std::int64_t> stamp_ns;
    std::int64_t period_ns;
    int intervals;  ///< Known, up to kFirst.
    Overdue overdue;
    bool counts;
  };

  /// The type of a topic is known when somebody publishes it.
  void find() {
    bool complete = true;
    for (Topic& topic : topics_) {
      if (topic.subscription) continue;
      const auto known = node_.get_topic_names_and_types();
      const auto found = known.find(topic.name);
      if (found == known.end() || found->second.empty()) {
        complete = false;
        continue;
      }
      topic.subscription = node_.create_generic_subscription(
          topic.name, found->second.front(), rclcpp::QoS(rclcpp::KeepLast(kDepth)).best_effort(),
          [this, &topic](std::shared_ptr<const rclcpp::SerializedMessage> bytes) {
            take(topic, bytes->get_rcl_serialized_message());
          });
    }
    if (complete) finder_->cancel();
  }

  void take(Topic& topic, const rcl_serialized_message_t& bytes) {
    const std::optional<std::int64_t> stamp_ns = stamp_of(bytes);
    if (!stamp_ns) return;
    if (topic.stamp_ns) {
      const std::int64_t apart_ns =
          std::clamp<std::int64_t>(*stamp_ns - *topic.stamp_ns, 0, kLongestPeriod_ns);
      if (topic.counts)
        topic.period_ns = learned(topic.period_ns, apart_ns);
      else
        topic.period_ns = std::max(topic.intervals > 0 ? topic.period_ns : 0, apart_ns);
      topic.intervals = std::min(topic.intervals + 1, kFirst);
    }
    topic.stamp_ns = stamp_ns;
    topic.overdue.none();
    topic.counts = topic.intervals == kFirst;
    on_message_();
  }

  /// Messages come early after a late one, so it forgets slowly. One that is lost on the way must not let time run further
  /// ahead, or more are lost, and more again.
  static std::int64_t learned(std::int64_t period_ns, std::int64_t apart_ns) {
    const std::int64_t more_ns = apart_ns - period_ns;
    return period_ns + more_ns / (more_ns > 0 ? kGrowing : kForgetting);
  }

  /// Of the header that a message begins with, after four bytes that encode the order of the others (CDR, OMG formal/2022-12-01,
  /// section 10).
  static std::optional<std::int64_t> stamp_of(const rcl_serialized_message_t& bytes) {
    constexpr std::size_t kStampAt = 4;
    if (bytes.buffer_length < kStampAt + 8) return {};
    const bool little = (bytes.buffer[1] & 1U) != 0;
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < 4; ++i)
        value |= static_cast<std::uint32_t>(bytes.buffer[at + i]) << (8 * (little ? i : 3 - i));
      return std::int64_t{value};
    };
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    if (word(kStampAt + 4) >= kSecond_ns) return {};
    return word(kStampAt) * kSecond_ns + word(kStampAt + 4);
  }

  rclcpp::Node& node_;
  std::function<void()> on_message_;
  std::list<Topic> topics_;  ///< Subscriptions hold addresses.
  rclcpp::TimerBase::SharedPtr finder_;
};

}  // namespace rosflight_sim
