// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "firmware/boards/parts/models/receiver_streams.hpp"
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

/// What a CRSF receiver sends: channels (992 is 1500 us, a step is 0.625 us) and the quality of its link [%].
inline parts::models::Bytes crsf_frames(const hal::RcFrame& rc) {
  constexpr float kMiddle = 992.0F, kStepsOfRange = 1600.0F;
  constexpr std::uint8_t kGoodQuality = 80;
  std::array<std::uint16_t, 16> raw{};
  for (std::size_t k = 0; k < raw.size(); ++k) {
    const float value = std::round(kMiddle + kStepsOfRange * (rc.channels[k] - 0.5F));
    raw[k] = static_cast<std::uint16_t>(std::clamp(value, 0.0F, 2047.0F));
  }
  const bool lost = rc.failsafe || rc.frame_lost;
  parts::models::Bytes all = parts::models::crsf_statistics(lost ? std::uint8_t{0} : kGoodQuality);
  const parts::models::Bytes channels =
      parts::models::crsf_frame(0x16, parts::models::pack_channels(raw));
  all.insert(all.end(), channels.begin(), channels.end());
  return all;
}

}  // namespace rosflight::boards::stm32h7::emulator
