// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace rosflight::boards::parts::models {

using Bytes = std::vector<std::uint8_t>;

/// Sixteen values of eleven bits as a bit string, lowest bit first: one bit after the other, unlike
/// the decoders.
inline Bytes pack_channels(const std::array<std::uint16_t, 16>& raw) {
  Bytes bytes(22, 0);
  for (std::size_t bit = 0; bit < std::size_t{16} * 11; ++bit) {
    if ((raw[bit / 11] >> (bit % 11) & 1) == 0) continue;
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] | 1u << (bit % 8));
  }
  return bytes;
}

/// One S.Bus frame.
inline Bytes sbus_frame(const std::array<std::uint16_t, 16>& raw, std::uint8_t flags = 0,
                        std::uint8_t footer = 0) {
  Bytes frame{0x0F};
  const Bytes channels = pack_channels(raw);
  frame.insert(frame.end(), channels.begin(), channels.end());
  frame.push_back(flags);
  frame.push_back(footer);
  return frame;
}

/// CRC-8 of DVB-S2 by long division of the message as a bit string.
inline std::uint8_t crc8_by_division(const Bytes& message) {
  std::uint32_t remainder = 0;
  for (std::size_t bit = 0; bit < (message.size() + 1) * 8; ++bit) {
    const unsigned next =
        bit / 8 < message.size() ? unsigned{message[bit / 8]} >> (7 - bit % 8) & 1u : 0u;
    remainder = remainder << 1 | next;
    if ((remainder & 0x100u) != 0) remainder ^= 0x1D5u;
  }
  return static_cast<std::uint8_t>(remainder);
}

/// One CRSF frame to the flight controller.
inline Bytes crsf_frame(std::uint8_t type, const Bytes& payload) {
  Bytes covered{type};
  covered.insert(covered.end(), payload.begin(), payload.end());
  Bytes frame{0xC8, static_cast<std::uint8_t>(covered.size() + 1)};
  frame.insert(frame.end(), covered.begin(), covered.end());
  frame.push_back(crc8_by_division(covered));
  return frame;
}

/// CRSF link statistics with this uplink quality [%].
inline Bytes crsf_statistics(std::uint8_t quality) {
  return crsf_frame(0x14, {60, 62, quality, 10, 0, 2, 3, 70, 99, 5});
}

}  // namespace rosflight::boards::parts::models
