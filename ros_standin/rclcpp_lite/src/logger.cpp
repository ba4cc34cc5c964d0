// SPDX-License-Identifier: BSD-3-Clause
#include "rclcpp/logger.hpp"

#include "rcl_call.hpp"

namespace rclcpp {

Logger get_logger(const std::string& name) {
  return Logger(name);
}

void Logger::set_level(Level level) {
  detail::check(rcutils_logging_set_logger_level(get_name(), static_cast<int>(level)),
                "set the level of logger '" + name_ + "'");
}

}  // namespace rclcpp
