// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/crc32.hpp"

namespace rosflight::core {

using base::Crc32;

/// Fletcher-16: two sums modulo 255; 0 becomes 0xFFFF so that blank memory never checks.
constexpr std::uint16_t fletcher16(const std::uint8_t* data, std::size_t size) {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  for (std::size_t k = 0; k < size; ++k) {
    first = (first + data[k]) % 255;
    second = (second + first) % 255;
  }
  const std::uint32_t sum = first * 256 + second;
  return static_cast<std::uint16_t>(sum == 0 ? 0xFFFFu : sum);
}

}  // namespace rosflight::core
