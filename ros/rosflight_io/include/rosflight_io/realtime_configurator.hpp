// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/int32.hpp>
#include <string>
#include <vector>

namespace rosflight_io {

/// Real-time scheduling of a node by words of its command line:
///
///     --realtime                  a real-time policy for this thread and those it starts
///     --policy:=RR | FIFO         which; RR if not given
///     --priority:=N               1 to 99; 87 if not given
///     --publish-context-switches  std_msgs/Int32 on <node name>/context_switches once a second:
///                                 involuntary context switches of the thread since the last one
///
///     const RealtimeConfigurator realtime{argc, argv};   // first of all, so that ROS's threads
///     realtime.apply();                                  // inherit it
///     rclcpp::init(argc, argv);
///     auto node = std::make_shared<MyNode>();
///     auto watch = realtime.watch(*node);                // keep it while the node spins
class RealtimeConfigurator {
 public:
  enum class Policy : std::uint8_t { kRoundRobin, kFifo };

  /// Reads its words and ignores the others. @throws std::invalid_argument  one line with what was
  /// found and what is allowed.
  RealtimeConfigurator(int argc, const char* const* argv);

  /// Nothing without --realtime. @throws std::runtime_error  the system refused, and why.
  void apply() const;

  /// Publishes for as long as it lives; made by watch() on the thread that spins the node.
  struct Watch {
    rclcpp::Publisher<std_msgs::msg::Int32>::SharedPtr publisher;
    rclcpp::TimerBase::SharedPtr timer;
  };
  /// Empty without --publish-context-switches.
  Watch watch(rclcpp::Node& node) const;

  bool realtime() const { return realtime_; }
  Policy policy() const { return policy_; }
  int priority() const { return priority_; }
  bool publishes_context_switches() const { return publishes_; }

 private:
  void read(const std::string& word);

  bool realtime_{false};
  Policy policy_{Policy::kRoundRobin};
  int priority_{87};
  bool publishes_{false};
};

}  // namespace rosflight_io
