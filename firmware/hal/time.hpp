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
/// In seconds; single precision resolves 1 us up to 16 s.
constexpr float seconds(Time t) {
  return static_cast<float>(t.count()) * 1e-6f;
}
/// In milliseconds, rounded towards zero.
constexpr std::int64_t to_ms(Time t) {
  return t.count() / 1000;
}

}  // namespace rosflight::hal
