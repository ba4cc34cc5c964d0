// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

namespace rosflight::companion {

/// Companion time: a monotonic clock of the caller's choice (simulated time in lock-step, the
/// steady clock in real time). Nothing in this folder reads a clock by itself.
using Time = std::chrono::nanoseconds;

inline constexpr Time kNever = Time::max();

constexpr double to_seconds(Time t) {
  return static_cast<double>(t.count()) * 1e-9;
}

/// Where the time of a sample comes from, best first.
enum class StampSource : std::uint8_t {
  kFcuClock,  ///< Stamped by the FCU, mapped with the clock offset.
  kImuPass,   ///< The FCU sends it unstamped, right after the IMU sample whose stamp it borrows:
              ///< early by less than one IMU period.
  kArrival    ///< Clocks not synchronised yet, or nothing better known.
};

/// When a message was received and when its content was true, both in companion time.
struct Stamp {
  Time arrival{};
  Time sample{};
  StampSource source{StampSource::kArrival};
};

}  // namespace rosflight::companion
