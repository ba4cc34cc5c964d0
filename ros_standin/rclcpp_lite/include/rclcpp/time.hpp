// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rcl/time.h>

#include <builtin_interfaces/msg/time.hpp>

#include "rclcpp/duration.hpp"

namespace rclcpp {

/// A point in time [ns] of one kind of clock. Points of different kinds do not mix: comparing or
/// subtracting them throws std::runtime_error.
class Time {
 public:
  Time(std::int32_t seconds, std::uint32_t nanoseconds, rcl_clock_type_t type = RCL_SYSTEM_TIME);
  explicit Time(std::int64_t nanoseconds = 0, rcl_clock_type_t type = RCL_SYSTEM_TIME);
  Time(const builtin_interfaces::msg::Time& message,  // NOLINT: implicit in rclcpp too
       rcl_clock_type_t type = RCL_ROS_TIME);
  explicit Time(const rcl_time_point_t& point) : rcl_time_(point) {}
  Time(const Time&) = default;
  Time& operator=(const Time&) = default;
  Time& operator=(const builtin_interfaces::msg::Time& message);

  /// Throws std::runtime_error for a negative time, which the message cannot hold.
  operator builtin_interfaces::msg::Time() const;  // NOLINT: implicit in rclcpp too

  bool operator==(const Time& other) const;
  bool operator!=(const Time& other) const { return !(*this == other); }
  bool operator<(const Time& other) const;
  bool operator<=(const Time& other) const { return !(other < *this); }
  bool operator>(const Time& other) const { return other < *this; }
  bool operator>=(const Time& other) const { return !(*this < other); }
  Time operator+(const Duration& span) const;
  Time operator-(const Duration& span) const;
  Duration operator-(const Time& other) const;
  Time& operator+=(const Duration& span) { return *this = *this + span; }
  Time& operator-=(const Duration& span) { return *this = *this - span; }

  static Time max();
  rcl_time_point_value_t nanoseconds() const { return rcl_time_.nanoseconds; }
  double seconds() const;
  rcl_clock_type_t get_clock_type() const { return rcl_time_.clock_type; }

 private:
  void must_match(const Time& other) const;
  rcl_time_point_t rcl_time_{};
};

Time operator+(const Duration& span, const Time& time);

}  // namespace rclcpp
