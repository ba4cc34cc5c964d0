// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>

namespace rosflight::hal {

/// Time since boot. 64 bits of microseconds last 292 000 years, so nothing ever has to handle a
/// wrap.
using Time = std::chrono::duration<std::int64_t, std::micro>;

constexpr Time microseconds(std::int64_t us) {
  return Time{us};
}
constexpr Time milliseconds(std::int64_t ms) {
  return Time{ms * 1000};
}
constexpr float seconds(Time t) {
  return static_cast<float>(t.count()) * 1e-6f;
}
constexpr std::int64_t to_ms(Time t) {
  return t.count() / 1000;
}

}  // namespace rosflight::hal
