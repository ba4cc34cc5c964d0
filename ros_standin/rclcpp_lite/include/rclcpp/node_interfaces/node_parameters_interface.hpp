// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "rclcpp/macros.hpp"
#include "rclcpp/parameter_value.hpp"

namespace rclcpp::node_interfaces {

/// What a node was given for its parameters before they were declared.
class NodeParametersInterface {
 public:
  RCLCPP_SMART_PTR_ALIASES_ONLY(NodeParametersInterface)
  virtual ~NodeParametersInterface() = default;
  /// By the command line, its files and the node's options.
  virtual const std::map<std::string, ParameterValue>& get_parameter_overrides() const = 0;
};

}  // namespace rclcpp::node_interfaces
