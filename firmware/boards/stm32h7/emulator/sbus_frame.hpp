// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "firmware/hal/samples.hpp"

namespace rosflight::boards::stm32h7::emulator {

using SbusFrame = std::array<std::uint8_t, 25>;

/// The frame that an S.Bus receiver sends: header 0x0F, 16 channels of 11 bits (172 to 1811 for 1000
/// to 2000 us), flags, end 0x00.
inline SbusFrame sbus_frame(const hal::RcFrame& rc) {
  constexpr float kLow = 172.0F, kSpan = 1639.0F;
  constexpr unsigned kChannels = 16, kBits = 11;
  SbusFrame frame{0x0F};
  for (unsigned c = 0; c < kChannels; ++c) {
    const float raw = std::round(kLow + kSpan * rc.channels[c]);
    const auto value = static_cast<std::uint32_t>(std::clamp(raw, 0.0F, 2047.0F));
    for (unsigned b = 0; b < kBits; ++b) {
      const unsigned at = kBits * c + b;
      if ((value >> b & 1U) == 0) continue;
      frame[1 + at / 8] = static_cast<std::uint8_t>(frame[1 + at / 8] | 1U << (at % 8));
    }
  }
  frame[23] = static_cast<std::uint8_t>((rc.frame_lost ? 4U : 0U) | (rc.failsafe ? 8U : 0U));
  return frame;
}

}  // namespace rosflight::boards::stm32h7::emulator
