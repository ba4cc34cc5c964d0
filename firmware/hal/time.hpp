// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

namespace rosflight::hal {

/// Time since boot. 64 bits of microseconds last 292 000 years, so no code handles a wrap.
using Time = std::chrono::duration<std::int64_t, std::micro>;

/// A time of so many microseconds.
constexpr Time microseconds(std::int64_t us) {
  return Time{us};
}
/// A time of so many milliseconds.
constexpr Time milliseconds(std::int64_t ms) {
  return Time{ms * 1000};
}
/// An interval in seconds; single precision resolves 1 us up to 16 s. Longer ones than 35 minutes count as
/// that: 32 bits are converted by one instruction, 64 by a library.
constexpr float seconds(Time t) {
  constexpr Time kLongest{0x7FFF'FFFF};
  const Time limited = t > kLongest ? kLongest : t < -kLongest ? -kLongest : t;
  return static_cast<float>(static_cast<std::int32_t>(limited.count())) * 1e-6f;
}
/// Quotient rounded towards zero, by digits of 16 bits: microcontrollers divide 32.
constexpr std::int64_t quotient(std::int64_t dividend, std::uint16_t divisor) {
  const bool negative = dividend < 0;
  const auto bits = static_cast<std::uint64_t>(dividend);
  const std::uint64_t size = negative ? 0 - bits : bits;
  std::uint64_t result = 0;
  std::uint32_t rest = 0;
  for (int shift = 48; shift >= 0; shift -= 16) {
    const std::uint32_t part = rest << 16 | static_cast<std::uint32_t>(size >> shift & 0xFFFFu);
    result = result << 16 | part / divisor;
    rest = part % divisor;
  }
  return static_cast<std::int64_t>(negative ? 0 - result : result);
}
/// In milliseconds, rounded towards zero.
constexpr std::int64_t to_ms(Time t) {
  return quotient(t.count(), 1000);
}

}  // namespace rosflight::hal
