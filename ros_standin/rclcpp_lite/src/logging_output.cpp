// SPDX-License-Identifier: BSD-3-Clause
#include "logging_output.hpp"

#include <rcl/logging.h>

#include <mutex>

#include "rcl_call.hpp"

namespace rclcpp::detail {

namespace {
/// rcl's outputs are one for the process and not safe to use from several threads. Never freed:
/// other statics may log while the process ends.
std::recursive_mutex& logging_mutex() {
  static auto* const mutex = new std::recursive_mutex;
  return *mutex;
}

void output(const rcutils_log_location_t* location, int severity, const char* name,
            rcutils_time_point_value_t timestamp, const char* format, va_list* arguments) {
  const std::lock_guard<std::recursive_mutex> lock(logging_mutex());
  rcl_logging_multiple_output_handler(location, severity, name, timestamp, format, arguments);
}
}  // namespace

void start_logging(const rcl_arguments_t& arguments) {
  const std::lock_guard<std::recursive_mutex> lock(logging_mutex());
  const auto allocator = rcl_get_default_allocator();
  check(rcl_logging_configure_with_output_handler(&arguments, &allocator, output), "start logging");
}

LoggingPause::LoggingPause() {
  logging_mutex().lock();
}
LoggingPause::~LoggingPause() {
  logging_mutex().unlock();
}

}  // namespace rclcpp::detail
