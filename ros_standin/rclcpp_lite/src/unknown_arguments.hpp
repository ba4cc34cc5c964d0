// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rcl/arguments.h>

#include <string>
#include <vector>

namespace rclcpp::detail {

/// The words of argv after --ros-args that rcl could not understand.
std::vector<std::string> unknown_ros_arguments(const rcl_arguments_t& arguments,
                                               char const* const* argv);

}  // namespace rclcpp::detail
