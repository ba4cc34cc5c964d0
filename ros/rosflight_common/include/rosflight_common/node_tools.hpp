// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <utility>
#include <vector>

/// What all nodes of the project do alike.
namespace rosflight_common {

/// Reliable, volatile, the newest message only: as all topics of the simulator but `clock`.
inline rclcpp::QoS newest() {
  return rclcpp::QoS(rclcpp::KeepLast(1)).reliable();
}

inline rcl_interfaces::msg::ParameterDescriptor described(const std::string& text,
                                                          bool read_only = true) {
  rcl_interfaces::msg::ParameterDescriptor descriptor;
  descriptor.description = text;
  descriptor.read_only = read_only;
  return descriptor;
}

/// Declares a number in a range. Live ones can be changed while the node runs.
inline double declare_number(rclcpp::Node& node, const std::string& name, double value,
                             double least, double most, const std::string& text,
                             bool live = false) {
  auto descriptor = described(text, !live);
  rcl_interfaces::msg::FloatingPointRange range;
  range.from_value = least;
  range.to_value = most;
  descriptor.floating_point_range.push_back(range);
  return node.declare_parameter<double>(name, value, descriptor);
}

inline std::int64_t declare_whole(rclcpp::Node& node, const std::string& name, std::int64_t value,
                                  std::int64_t least, std::int64_t most, const std::string& text,
                                  bool live = false) {
  auto descriptor = described(text, !live);
  rcl_interfaces::msg::IntegerRange range;
  range.from_value = least;
  range.to_value = most;
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

/// Calls `changed` after every accepted change of parameters declared live. Keep what is returned.
inline rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_change(
    rclcpp::Node& node, std::function<void(const rclcpp::Parameter&)> changed) {
  return node.add_on_set_parameters_callback(
      [changed = std::move(changed)](const std::vector<rclcpp::Parameter>& parameters) {
        for (const auto& parameter : parameters) changed(parameter);
        rcl_interfaces::msg::SetParametersResult result;
        result.successful = true;
        return result;
      });
}

/// As on_change, for all parameters of one request together; a text that comes back is the reason
/// why the change is refused, and then nothing may have changed.
inline rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr on_change_or_refuse(
    rclcpp::Node& node, std::function<std::string(const std::vector<rclcpp::Parameter>&)> changed) {
  return node.add_on_set_parameters_callback(
      [changed = std::move(changed)](const std::vector<rclcpp::Parameter>& parameters) {
        rcl_interfaces::msg::SetParametersResult result;
        result.reason = changed(parameters);
        result.successful = result.reason.empty();
        return result;
      });
}

/// A client whose answers come in a callback group of its own. Humble and later distributions
/// disagree on the type of the argument in the middle.
template <class Service, class NodeType>
typename rclcpp::Client<Service>::SharedPtr client_in_group(
    NodeType& node, const std::string& name, rclcpp::CallbackGroup::SharedPtr group) {
  if constexpr (requires {
                  node.template create_client<Service>(name, rclcpp::ServicesQoS(), group);
                }) {
    return node.template create_client<Service>(name, rclcpp::ServicesQoS(), group);
  } else {
    return node.template create_client<Service>(name, rmw_qos_profile_services_default, group);
  }
}

/// What went wrong in one line: without the places in the sources of ROS that rcl adds.
inline std::string one_line(const std::string& text) {
  std::string line = text.substr(0, std::min(text.find(", at /"), text.find('\n')));
  return line.empty() ? "failed without saying why" : line;
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
    const auto node = std::make_shared<NodeType>(rclcpp::NodeOptions());
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
