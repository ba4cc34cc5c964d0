// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

/// What all nodes of the project do alike.
namespace rosflight_common {

/// Reliable, volatile, the newest message only: as all topics of the simulator but `clock`.
inline rclcpp::QoS newest() {
  return rclcpp::QoS(rclcpp::KeepLast(1)).reliable();
}

/// For a subscription to what comes again and again: a message that is lost is followed by a newer one, so its publisher is not told of
/// each that arrived. Takes publishers of either reliability.
inline rclcpp::QoS stream(std::size_t depth = 1) {
  return rclcpp::QoS(rclcpp::KeepLast(depth)).best_effort();
}

inline rcl_interfaces::msg::ParameterDescriptor described(const std::string& text,
                                                          bool read_only = true) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = text;
  descriptor.read_only = read_only;
  return descriptor;
}

inline std::string not_finite(const std::string& parameter) {
  return "parameter " + parameter + ": found nan or infinity, allowed a finite number";
}

/// Declares a number in a range. Live ones can be changed while the node runs.
/// A whole number that is given (`real_time_multiplier:=10`), which is an integer for ROS, is good for it.
/// @throws std::invalid_argument  for NaN and infinity, which rclcpp finds in every range; else what it throws.
inline double declare_number(rclcpp::Node& node, const std::string& name, double value, double min,
                             double max, const std::string& text, bool live = false) {
  auto descriptor = described(text, !live);
  rcl_interfaces::msg::FloatingPointRange range;
  range.from_value = min;
  range.to_value = max;
  descriptor.floating_point_range.push_back(range);
  const auto& overrides = node.get_node_parameters_interface()->get_parameter_overrides();
  const auto found = overrides.find(name);
  const bool whole = found != overrides.end() &&
                     found->second.get_type() == rclcpp::ParameterType::PARAMETER_INTEGER;
  if (whole) value = static_cast<double>(found->second.get<std::int64_t>());
  const double given = node.declare_parameter<double>(name, value, descriptor, whole);
  if (!std::isfinite(given)) throw std::invalid_argument(not_finite(name));
  return given;
}

inline std::int64_t declare_integer(rclcpp::Node& node, const std::string& name, std::int64_t value,
                                    std::int64_t min, std::int64_t max, const std::string& text,
                                    bool live = false) {
  auto descriptor = described(text, !live);
  rcl_interfaces::msg::IntegerRange range;
  range.from_value = min;
  range.to_value = max;
  range.step = 1;
  descriptor.integer_range.push_back(range);
  return node.declare_parameter<std::int64_t>(name, value, descriptor);
}

inline std::string declare_text(rclcpp::Node& node, const std::string& name,
                                const std::string& value, const std::string& text) {
  return node.declare_parameter<std::string>(name, value, described(text));
}

inline bool declare_switch(rclcpp::Node& node, const std::string& name, bool value,
                           const std::string& text) {
  return node.declare_parameter<bool>(name, value, described(text));
}

/// One request for parameters as all nodes of the project answer it: rclcpp lets NaN and infinity through every
/// range and ends the process on an exception, so both become a refusal here.
inline rcl_interfaces::msg::SetParametersResult answer_change(
    const std::vector<rclcpp::Parameter>& parameters,
    const std::function<std::string(const std::vector<rclcpp::Parameter>&)>& changed) {
  rcl_interfaces::msg::SetParametersResult result;
  for (const auto& parameter : parameters) {
    if (parameter.get_type() == rclcpp::ParameterType::PARAMETER_DOUBLE &&
        !std::isfinite(parameter.as_double()))
      result.reason = not_finite(parameter.get_name());
  }
  try {
    if (result.reason.empty()) result.reason = changed(parameters);
  } catch (const std::exception& why) {
    result.reason = why.what();
  }
  result.successful = result.reason.empty();
  return result;
}

/// Calls `changed` after every accepted change of parameters declared live. Keep what is returned.
inline rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_change(
    rclcpp::Node& node, std::function<void(const rclcpp::Parameter&)> changed) {
  return node.add_on_set_parameters_callback(
      [changed = std::move(changed)](const std::vector<rclcpp::Parameter>& parameters) {
        return answer_change(parameters, [&changed](const std::vector<rclcpp::Parameter>& given) {
          for (const auto& parameter : given) changed(parameter);
          return std::string{};
        });
      });
}

/// As on_change, for all parameters of one request together; a text that comes back, or an exception, is
/// the reason why the change is refused, and then nothing may have changed.
inline rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_change_or_refuse(
    rclcpp::Node& node, std::function<std::string(const std::vector<rclcpp::Parameter>&)> changed) {
  return node.add_on_set_parameters_callback(
      [changed = std::move(changed)](const std::vector<rclcpp::Parameter>& parameters) {
        return answer_change(parameters, changed);
      });
}

/// What went wrong in one line: without the places in the sources of ROS that rcl adds.
inline std::string one_line(const std::string& text) {
  std::string line = text.substr(0, std::min(text.find(", at /"), text.find('\n')));
  return line.empty() ? "failed without saying why" : line;
}

/// The node time at which a message counts as received. On a loaded machine simulated time may reach a node after messages that
/// were stamped with it: then it is the stamp, or the clock that catches up makes a topic silent that never was.
inline rclcpp::Time received_at(rclcpp::Node& node, const builtin_interfaces::msg::Time& stamp) {
  const rclcpp::Time now = node.now();
  if (!node.get_clock()->ros_time_is_active()) return now;
  static constexpr double kMaxAhead_s = 1.0;  // a clock that has been set back
  const rclcpp::Time stamped(stamp, now.get_clock_type());
  const double ahead_s = (stamped - now).seconds();
  return ahead_s > 0.0 && ahead_s < kMaxAhead_s ? stamped : now;
}

/// To be called after a subscription, timer, service or client of a living node has been destroyed. rclcpp 28 makes its
/// wait set again for those that come but not for those that go: until then it takes from the wrong ones and never rests.
inline void tell_executor(rclcpp::Node& node) {
  node.for_each_callback_group([](const rclcpp::CallbackGroup::SharedPtr& group) {
    group->trigger_notify_guard_condition();
  });
}

/// Warns every 5 s while the node is to follow simulated time and there is none. Keep what is returned.
inline rclcpp::TimerBase::SharedPtr warn_without_clock(rclcpp::Node& node) {
  if (!node.get_clock()->ros_time_is_active()) return nullptr;
  static constexpr std::chrono::seconds kPeriod{5};
  return node.create_wall_timer(kPeriod, [&node] {
    if (node.now().nanoseconds() == 0)
      RCLCPP_WARN(node.get_logger(), "use_sim_time is true and no /clock came for %ld s",
                  static_cast<long>(kPeriod.count()));
  });
}

/// The whole of a node's main(): says `ready` when the node stands, one line and exit code 2 if it
/// cannot be made.
template <class NodeType, class Executor = rclcpp::executors::SingleThreadedExecutor>
int run_node(int argc, char** argv) {
  int code = 0;
  bool started = false;
  try {
    rclcpp::init(argc, argv);
    started = true;
    // Callbacks of one thread that return at once need no second one for the clock: it would be one more to wake at each tick.
    constexpr bool kMayWait = !std::is_same_v<Executor, rclcpp::executors::SingleThreadedExecutor>;
    const auto node = std::make_shared<NodeType>(rclcpp::NodeOptions().use_clock_thread(kMayWait));
    const auto watch = warn_without_clock(*node);
    Executor executor;
    executor.add_node(node);
    RCLCPP_INFO(node->get_logger(), "ready");
    executor.spin();
  } catch (const std::exception& why) {
    // SIGINT while the node is being made leaves nothing to make it in: an end like any other.
    if (started && !rclcpp::ok()) return 0;
    const std::string program = argc > 0 ? argv[0] : "node";
    std::fprintf(stderr, "%s: %s\n", program.substr(program.rfind('/') + 1).c_str(),
                 one_line(why.what()).c_str());
    code = 2;
  }
  rclcpp::shutdown();
  return code;
}

}  // namespace rosflight_common
