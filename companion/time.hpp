// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

namespace rosflight::companion {

/// Companion time: a monotonic clock chosen by the caller (simulated time in lock-step, the steady
/// clock in real time). No code in this folder reads a clock itself.
using Time = std::chrono::nanoseconds;

inline constexpr Time kNever = Time::max();

/// After so long a message that found the send queue full, or the link closed, is tried again.
inline constexpr Time kQueueFull = std::chrono::milliseconds{10};

/// Time in seconds.
constexpr double to_seconds(Time t) {
  return static_cast<double>(t.count()) * 1e-9;
}

/// Source of the time of a sample, best first.
enum class StampSource : std::uint8_t {
  kFcuClock,  ///< Stamped by the FCU, mapped with the clock offset.
  kImuPass,   ///< Sent without a stamp, directly after the IMU sample whose stamp is used: early by
              ///< less than one IMU period.
  kArrival    ///< Clocks not synchronised yet, or no better time available.
};

/// Times of arrival and of the sample, both in companion time.
struct Stamp {
  Time arrival{};
  Time sample{};
  StampSource source{StampSource::kArrival};
};

}  // namespace rosflight::companion
