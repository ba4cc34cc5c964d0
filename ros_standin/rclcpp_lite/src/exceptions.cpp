// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/exceptions.hpp"

#include <rcl/error_handling.h>
#include <rcutils/logging_macros.h>

#include "rcl_call.hpp"

namespace rclcpp {

namespace exceptions {

void throw_from_rcl_error(rcl_ret_t code, const std::string& doing) {
  const std::string text = "could not " + doing + ": " + rcl_get_error_string().str;
  rcl_reset_error();
  switch (code) {
    case RCL_RET_BAD_ALLOC:
      throw std::bad_alloc();
    case RCL_RET_NODE_INVALID_NAME:
      throw InvalidNodeNameError(text);
    case RCL_RET_NODE_INVALID_NAMESPACE:
      throw InvalidNamespaceError(text);
    case RCL_RET_TOPIC_NAME_INVALID:
      throw InvalidTopicNameError(text);
    case RCL_RET_SERVICE_NAME_INVALID:
      throw InvalidServiceNameError(text);
    default:
      throw RCLError(code, text);
  }
}

namespace {
std::string listed(const std::vector<std::string>& words) {
  std::string text = "unknown ROS arguments:";
  for (const auto& word : words) text += " '" + word + "'";
  return text;
}
}  // namespace

UnknownROSArgsError::UnknownROSArgsError(std::vector<std::string>&& words)
    : std::runtime_error(listed(words)), unknown_ros_args(std::move(words)) {}

}  // namespace exceptions

void detail::complain(rcl_ret_t code, const char* doing) {
  if (code == RCL_RET_OK) return;
  RCUTILS_LOG_ERROR_NAMED("rclcpp", "could not %s: %s", doing, rcl_get_error_string().str);
  rcl_reset_error();
}

}  // namespace rclcpp
