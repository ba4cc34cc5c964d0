// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rclcpp/rclcpp.hpp>
#include <string>

#include "companion/parameter.hpp"

namespace rosflight_io {

/// What `ros2 param describe` prints about a parameter of the firmware: meaning, unit, range and values outside the range
/// that are allowed too, from the table of this project's firmware. ROS has one interval for each parameter, so it spans
/// these values as well; `additional_constraints` has what is allowed exactly, and the firmware refuses the rest.
///
/// A parameter that the table does not have, has with another type, or whose present value is out of range belongs to another
/// firmware: no range then.
rcl_interfaces::msg::ParameterDescriptor describe_parameter(
    const std::string& name, const rosflight::companion::ParameterValue& present);

}  // namespace rosflight_io
