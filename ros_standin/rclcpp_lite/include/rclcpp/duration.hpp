// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/time.h>
#include <rmw/types.h>

#include <builtin_interfaces/msg/duration.hpp>
#include <chrono>
#include <cstdint>

namespace rclcpp {

/// A span of time [ns]. Arithmetic throws std::overflow_error where it would not fit.
class Duration {
 public:
  Duration(std::int32_t seconds, std::uint32_t nanoseconds);
  explicit Duration(std::chrono::nanoseconds nanoseconds);
  template <class Rep, class Period>
  Duration(const std::chrono::duration<Rep, Period>& duration)  // NOLINT: implicit in rclcpp too
      : Duration(std::chrono::duration_cast<std::chrono::nanoseconds>(duration)) {}
  Duration(const builtin_interfaces::msg::Duration& message);  // NOLINT: implicit in rclcpp too
  explicit Duration(const rcl_duration_t& duration);
  Duration(const Duration&) = default;
  Duration& operator=(const Duration&) = default;
  Duration& operator=(const builtin_interfaces::msg::Duration& message);

  operator builtin_interfaces::msg::Duration() const;  // NOLINT: implicit in rclcpp too

  bool operator==(const Duration& other) const { return ns() == other.ns(); }
  bool operator!=(const Duration& other) const { return ns() != other.ns(); }
  bool operator<(const Duration& other) const { return ns() < other.ns(); }
  bool operator<=(const Duration& other) const { return ns() <= other.ns(); }
  bool operator>(const Duration& other) const { return ns() > other.ns(); }
  bool operator>=(const Duration& other) const { return ns() >= other.ns(); }
  Duration operator+(const Duration& other) const;
  Duration operator-(const Duration& other) const;
  Duration operator*(double scale) const;
  Duration& operator+=(const Duration& other) { return *this = *this + other; }
  Duration& operator-=(const Duration& other) { return *this = *this - other; }
  Duration& operator*=(double scale) { return *this = *this * scale; }

  static Duration max();
  static Duration from_seconds(double seconds);
  static Duration from_nanoseconds(rcl_duration_value_t nanoseconds);
  static Duration from_rmw_time(rmw_time_t duration);

  rcl_duration_value_t nanoseconds() const { return ns(); }
  double seconds() const;
  rmw_time_t to_rmw_time() const;
  template <class DurationT>
  DurationT to_chrono() const {
    return std::chrono::duration_cast<DurationT>(std::chrono::nanoseconds(ns()));
  }

 private:
  rcl_duration_value_t ns() const { return rcl_duration_.nanoseconds; }
  rcl_duration_t rcl_duration_{};
};

}  // namespace rclcpp
