// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcutils/logging_macros.h>

#include <sstream>

#include "rclcpp/clock.hpp"
#include "rclcpp/logger.hpp"
#include "rclcpp/utilities.hpp"

namespace rclcpp::detail {
/// Takes a logger only: a node has a name as well, but rclcpp refuses it.
inline const char* name_of(const Logger& logger) {
  return logger.get_name();
}
}  // namespace rclcpp::detail

// Macros because the place in the source, the condition and the text must not be evaluated twice or
// for nothing. RCLCPP_<SEVERITY>[_STREAM][_ONCE|_EXPRESSION|_SKIPFIRST|_THROTTLE](logger, ...).

#define RCLCPP_LITE_STREAM_TEXT(stream) \
  ([&]() -> std::string {               \
    std::ostringstream text_;           \
    text_ << stream;                    \
    return text_.str();                 \
  }())

// rcutils wants a function that reads the clock [ns]; `period_ms` is in milliseconds.
#define RCLCPP_LITE_READ_CLOCK(clock)                      \
  [&](rcutils_time_point_value_t* now_) -> rcutils_ret_t { \
    *now_ = (clock).now().nanoseconds();                   \
    return RCUTILS_RET_OK;                                 \
  }

#define RCLCPP_DEBUG(logger, ...) \
  RCUTILS_LOG_DEBUG_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_DEBUG_ONCE(logger, ...) \
  RCUTILS_LOG_DEBUG_ONCE_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_DEBUG_EXPRESSION(logger, expression, ...) \
  RCUTILS_LOG_DEBUG_EXPRESSION_NAMED(expression, ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_DEBUG_SKIPFIRST(logger, ...) \
  RCUTILS_LOG_DEBUG_SKIPFIRST_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_DEBUG_THROTTLE(logger, clock, period_ms, ...)                 \
  RCUTILS_LOG_DEBUG_THROTTLE_NAMED(RCLCPP_LITE_READ_CLOCK(clock), period_ms, \
                                   ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_DEBUG_STREAM(logger, stream) \
  RCLCPP_DEBUG(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_DEBUG_STREAM_ONCE(logger, stream) \
  RCLCPP_DEBUG_ONCE(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_DEBUG_STREAM_EXPRESSION(logger, expression, stream) \
  RCLCPP_DEBUG_EXPRESSION(logger, expression, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_DEBUG_STREAM_SKIPFIRST(logger, stream) \
  RCLCPP_DEBUG_SKIPFIRST(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_DEBUG_STREAM_THROTTLE(logger, clock, period_ms, stream) \
  RCLCPP_DEBUG_THROTTLE(logger, clock, period_ms, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())

#define RCLCPP_INFO(logger, ...) \
  RCUTILS_LOG_INFO_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_INFO_ONCE(logger, ...) \
  RCUTILS_LOG_INFO_ONCE_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_INFO_EXPRESSION(logger, expression, ...) \
  RCUTILS_LOG_INFO_EXPRESSION_NAMED(expression, ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_INFO_SKIPFIRST(logger, ...) \
  RCUTILS_LOG_INFO_SKIPFIRST_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_INFO_THROTTLE(logger, clock, period_ms, ...)                 \
  RCUTILS_LOG_INFO_THROTTLE_NAMED(RCLCPP_LITE_READ_CLOCK(clock), period_ms, \
                                  ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_INFO_STREAM(logger, stream) \
  RCLCPP_INFO(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_INFO_STREAM_ONCE(logger, stream) \
  RCLCPP_INFO_ONCE(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_INFO_STREAM_EXPRESSION(logger, expression, stream) \
  RCLCPP_INFO_EXPRESSION(logger, expression, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_INFO_STREAM_SKIPFIRST(logger, stream) \
  RCLCPP_INFO_SKIPFIRST(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_INFO_STREAM_THROTTLE(logger, clock, period_ms, stream) \
  RCLCPP_INFO_THROTTLE(logger, clock, period_ms, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())

#define RCLCPP_WARN(logger, ...) \
  RCUTILS_LOG_WARN_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_WARN_ONCE(logger, ...) \
  RCUTILS_LOG_WARN_ONCE_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_WARN_EXPRESSION(logger, expression, ...) \
  RCUTILS_LOG_WARN_EXPRESSION_NAMED(expression, ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_WARN_SKIPFIRST(logger, ...) \
  RCUTILS_LOG_WARN_SKIPFIRST_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_WARN_THROTTLE(logger, clock, period_ms, ...)                 \
  RCUTILS_LOG_WARN_THROTTLE_NAMED(RCLCPP_LITE_READ_CLOCK(clock), period_ms, \
                                  ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_WARN_STREAM(logger, stream) \
  RCLCPP_WARN(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_WARN_STREAM_ONCE(logger, stream) \
  RCLCPP_WARN_ONCE(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_WARN_STREAM_EXPRESSION(logger, expression, stream) \
  RCLCPP_WARN_EXPRESSION(logger, expression, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_WARN_STREAM_SKIPFIRST(logger, stream) \
  RCLCPP_WARN_SKIPFIRST(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_WARN_STREAM_THROTTLE(logger, clock, period_ms, stream) \
  RCLCPP_WARN_THROTTLE(logger, clock, period_ms, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())

#define RCLCPP_ERROR(logger, ...) \
  RCUTILS_LOG_ERROR_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_ERROR_ONCE(logger, ...) \
  RCUTILS_LOG_ERROR_ONCE_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_ERROR_EXPRESSION(logger, expression, ...) \
  RCUTILS_LOG_ERROR_EXPRESSION_NAMED(expression, ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_ERROR_SKIPFIRST(logger, ...) \
  RCUTILS_LOG_ERROR_SKIPFIRST_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_ERROR_THROTTLE(logger, clock, period_ms, ...)                 \
  RCUTILS_LOG_ERROR_THROTTLE_NAMED(RCLCPP_LITE_READ_CLOCK(clock), period_ms, \
                                   ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_ERROR_STREAM(logger, stream) \
  RCLCPP_ERROR(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_ERROR_STREAM_ONCE(logger, stream) \
  RCLCPP_ERROR_ONCE(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_ERROR_STREAM_EXPRESSION(logger, expression, stream) \
  RCLCPP_ERROR_EXPRESSION(logger, expression, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_ERROR_STREAM_SKIPFIRST(logger, stream) \
  RCLCPP_ERROR_SKIPFIRST(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_ERROR_STREAM_THROTTLE(logger, clock, period_ms, stream) \
  RCLCPP_ERROR_THROTTLE(logger, clock, period_ms, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())

#define RCLCPP_FATAL(logger, ...) \
  RCUTILS_LOG_FATAL_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_FATAL_ONCE(logger, ...) \
  RCUTILS_LOG_FATAL_ONCE_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_FATAL_EXPRESSION(logger, expression, ...) \
  RCUTILS_LOG_FATAL_EXPRESSION_NAMED(expression, ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_FATAL_SKIPFIRST(logger, ...) \
  RCUTILS_LOG_FATAL_SKIPFIRST_NAMED(::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_FATAL_THROTTLE(logger, clock, period_ms, ...)                 \
  RCUTILS_LOG_FATAL_THROTTLE_NAMED(RCLCPP_LITE_READ_CLOCK(clock), period_ms, \
                                   ::rclcpp::detail::name_of(logger), __VA_ARGS__)
#define RCLCPP_FATAL_STREAM(logger, stream) \
  RCLCPP_FATAL(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_FATAL_STREAM_ONCE(logger, stream) \
  RCLCPP_FATAL_ONCE(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_FATAL_STREAM_EXPRESSION(logger, expression, stream) \
  RCLCPP_FATAL_EXPRESSION(logger, expression, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_FATAL_STREAM_SKIPFIRST(logger, stream) \
  RCLCPP_FATAL_SKIPFIRST(logger, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
#define RCLCPP_FATAL_STREAM_THROTTLE(logger, clock, period_ms, stream) \
  RCLCPP_FATAL_THROTTLE(logger, clock, period_ms, "%s", RCLCPP_LITE_STREAM_TEXT(stream).c_str())
