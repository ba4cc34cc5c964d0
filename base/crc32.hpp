// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace rosflight::base {

namespace detail {

constexpr std::array<std::uint32_t, 16> crc_of_nibbles() {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t k = 0; k < table.size(); ++k) {
    std::uint32_t state = k;
    for (int bit = 0; bit < 4; ++bit) state = (state >> 1) ^ (0xEDB88320u & (0u - (state & 1u)));
    table[k] = state;
  }
  return table;
}
inline constexpr std::array<std::uint32_t, 16> kCrcOfNibble = crc_of_nibbles();

}  // namespace detail

/// CRC-32 (IEEE 802.3, reflected 0xEDB88320), four bits at a time: used for storage only, where a
/// table of 64 bytes is worth its flash and one of 1 kB is not. Check value of "123456789":
/// 0xCBF43926.
class Crc32 {
 public:
  /// Continues the checksum over `size` bytes.
  void add(const std::uint8_t* data, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k) {
      state_ ^= data[k];
      state_ = (state_ >> 4) ^ detail::kCrcOfNibble[state_ & 0xFu];
      state_ = (state_ >> 4) ^ detail::kCrcOfNibble[state_ & 0xFu];
    }
  }
  std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_{0xFFFFFFFFu};
};

}  // namespace rosflight::base
