// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "rosflight_common/node_tools.hpp"
#include "rosflight_sim/timer_phase.hpp"
#include "rosflight_sim/topic_pace.hpp"

namespace rosflight_sim {

/// Topics that simulated time must not leave behind: who publishes them has dealt with the world up to their stamps.
///
/// Any type whose first field is a std_msgs/Header. How long time waits for each: TopicPace.
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
      topics_.push_back({name, nullptr, {}, {}});
    }
    if (topics_.empty()) return;
    finder_ = node.create_wall_timer(std::chrono::milliseconds(100), [this] { find(); });
  }

  /// How time goes on.
  struct Pace {
    std::int64_t lag_ns{};   ///< Allowed after a message was due; seen before each step.
    std::int64_t step_ns{};  ///< Between two steps.
    std::int64_t tick_ns{};  ///< Between two of the finer ticks; 0: there are none.
  };

  /// Whether the step that follows `time_ns` must wait for one of them. Tells once of each that is given up.
  /// @param told_ns  the last tick
  bool behind(std::int64_t time_ns, std::int64_t told_ns, const Pace& pace, Wall::time_point now) {
    time_ns_ = time_ns;
    tick_ns_ = pace.tick_ns;
    bool any = false;
    for (Topic& topic : topics_) {
      const TopicPace::Look look = look_at(topic, told_ns, pace, now);
      any = any || look == TopicPace::Look::kBehind;
      if (look != TopicPace::Look::kGivenUp) continue;
      topic.phase = {};
      RCLCPP_WARN(node_.get_logger(), "no %s for %ld s: time goes on without it",
                  topic.name.c_str(), static_cast<long>(Overdue::kGiveUp.count()));
    }
    return any;
  }

  /// Where the finer ticks must stop until a message of each node that follows them has come.
  std::int64_t ticks_end_ns(const Pace& pace) const {
    std::int64_t end_ns = kNoEnd;
    for (const Topic& topic : topics_)
      if (follows_ticks(topic, pace))
        end_ns = std::min(end_ns, topic.phase.ticks_end_ns(pace.tick_ns, pace.lag_ns));
    return end_ns;
  }
  static constexpr std::int64_t kNoEnd = std::numeric_limits<std::int64_t>::max();

 private:
  static constexpr std::size_t kDepth =
      50;  // a message that is not read makes its topic seem half as frequent

  struct Topic {
    std::string name;
    std::shared_ptr<rclcpp::SubscriptionBase> subscription;
    TopicPace pace;
    TimerPhase phase;
  };

  static bool follows_ticks(const Topic& topic, const Pace& pace) {
    return topic.pace.counts() && topic.phase.follows(pace.tick_ns, pace.step_ns);
  }

  TopicPace::Look look_at(Topic& topic, std::int64_t told_ns, const Pace& pace,
                          Wall::time_point now) const {
    if (!follows_ticks(topic, pace)) return topic.pace.look(time_ns_, pace.lag_ns, now);
    const std::int64_t end_ns = topic.phase.ticks_end_ns(pace.tick_ns, pace.lag_ns);
    const bool overdue = time_ns_ + pace.step_ns > end_ns;
    if (overdue && told_ns + pace.tick_ns > end_ns) topic.phase.stands(now);
    return topic.pace.look(overdue, now);
  }

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
    topic.pace.came(*stamp_ns, time_ns_);
    topic.phase.called(*stamp_ns, tick_ns_);
    on_message_();
  }

  /// Stamp of the header that a message begins with, after four bytes that encode the order of the others (CDR, OMG formal/2022-12-01,
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
  std::int64_t time_ns_{};  ///< At the last look.
  std::int64_t tick_ns_{};
};

}  // namespace rosflight_sim
