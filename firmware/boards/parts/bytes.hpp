// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

/// Numbers out of bytes, as parts send them.
namespace rosflight::boards::parts {

/// Parts give temperatures in degrees Celsius.
inline constexpr float kZeroCelsius_K = 273.15f;

constexpr std::int16_t le16(const std::uint8_t* p) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(p[0] | p[1] << 8));
}
constexpr std::uint16_t be16(const std::uint8_t* p) {
  return static_cast<std::uint16_t>(p[0] << 8 | p[1]);
}
constexpr std::uint32_t be24(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) << 16 | static_cast<std::uint32_t>(p[1]) << 8 | p[2];
}
constexpr std::uint32_t le32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}
constexpr std::int32_t le32_signed(const std::uint8_t* p) {
  return static_cast<std::int32_t>(le32(p));
}
/// Two's complement of `bits` bits.
constexpr std::int32_t sign_extend(std::uint32_t value, unsigned bits) {
  const std::uint32_t sign = 1u << (bits - 1);
  return static_cast<std::int32_t>((value & (2 * sign - 1)) ^ sign) -
         static_cast<std::int32_t>(sign);
}
constexpr void put_le16(std::uint8_t* p, std::uint16_t value) {
  for (int k = 0; k < 2; ++k) p[k] = static_cast<std::uint8_t>(value >> (8 * k));
}
constexpr void put_le32(std::uint8_t* p, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) p[k] = static_cast<std::uint8_t>(value >> (8 * k));
}

}  // namespace rosflight::boards::parts
