// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcutils/logging.h>

#include <string>

namespace rclcpp {

/// A name under which to log; levels belong to names.
class Logger {
 public:
  enum class Level {
    Unset = RCUTILS_LOG_SEVERITY_UNSET,
    Debug = RCUTILS_LOG_SEVERITY_DEBUG,
    Info = RCUTILS_LOG_SEVERITY_INFO,
    Warn = RCUTILS_LOG_SEVERITY_WARN,
    Error = RCUTILS_LOG_SEVERITY_ERROR,
    Fatal = RCUTILS_LOG_SEVERITY_FATAL,
  };
  const char* get_name() const { return name_.c_str(); }
  void set_level(Level level);

 private:
  friend Logger get_logger(const std::string& name);
  explicit Logger(std::string name) : name_(std::move(name)) {}
  std::string name_;
};

Logger get_logger(const std::string& name);

}  // namespace rclcpp
