// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <set>
#include <string>
#include <vector>

#include "companion/asio/runner.hpp"
#include "companion/listener.hpp"

namespace rosflight_io {

/// Every parameter of the firmware as a ROS parameter of the same name, both ways: a set waits for
/// the firmware's answer and is refused with its reason; a change seen from the firmware changes
/// the ROS parameter. Declared as soon as the list is complete.
class ParameterMirror final : public rosflight::companion::Listener {
 public:
  ParameterMirror(rclcpp::Node& node, rosflight::companion::Runner& runner);

  /// By the link's thread: remembers what is new.
  void on_event(const rosflight::companion::Event& event) override;
  /// Declares and updates; call it in the node's thread.
  void update();

 private:
  using Set = rosflight::companion::ParameterSet;

  rcl_interfaces::msg::SetParametersResult on_set(const std::vector<rclcpp::Parameter>& parameters);
  /// Empty if the firmware has taken it, else why not.
  std::string send(const rclcpp::Parameter& parameter);
  void mirror(const rosflight::companion::NamedValue& entry);
  /// Declares the ROS parameter; if another value is given on the command line or in a file, sends that. As send().
  std::string declare(const rosflight::companion::NamedValue& entry);

  rclcpp::Node& node_;
  rosflight::companion::Runner& runner_;
  rclcpp::node_interfaces::OnSetParametersCallbackHandle::SharedPtr handle_;
  std::set<std::string> known_;  ///< Names of the firmware that are declared.
  bool mirroring_{false};        ///< A set that comes from the firmware.

  std::mutex mutex_;  ///< Protects news_.
  Set news_;
};

}  // namespace rosflight_io
