// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rcl/arguments.h>

namespace rclcpp::detail {

/// Sends what is logged to the console, the log file and /rosout, as the arguments specify.
void start_logging(const rcl_arguments_t& arguments);

/// While it lives nothing is logged: the publishers behind /rosout may change.
class LoggingPause {
 public:
  LoggingPause();
  ~LoggingPause();
  LoggingPause(const LoggingPause&) = delete;
  LoggingPause& operator=(const LoggingPause&) = delete;
};

}  // namespace rclcpp::detail
