// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <builtin_interfaces/msg/time.hpp>
#include <cstdint>
#include <std_msgs/msg/header.hpp>

namespace rosflight_common {

inline std::int64_t nanoseconds(const builtin_interfaces::msg::Time& stamp) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  return static_cast<std::int64_t>(stamp.sec) * kSecond_ns +
         static_cast<std::int64_t>(stamp.nanosec);
}

/// The stamp of a time; a time before 0 counts as 0.
inline builtin_interfaces::msg::Time stamp_of(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t t = std::max<std::int64_t>(nanoseconds, 0);
  builtin_interfaces::msg::Time stamp;
  stamp.sec = static_cast<std::int32_t>(t / kSecond_ns);
  stamp.nanosec = static_cast<std::uint32_t>(t % kSecond_ns);
  return stamp;
}

/// Stamp as the time that the classes of autonomy/ take: doubles hold today's to 0.24 us.
inline double seconds(const std_msgs::msg::Header& header) {
  return static_cast<double>(header.stamp.sec) + 1e-9 * static_cast<double>(header.stamp.nanosec);
}

}  // namespace rosflight_common
