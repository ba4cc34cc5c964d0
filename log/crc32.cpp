// SPDX-License-Identifier: BSD-3-Clause
#include "log/crc32.hpp"

#include <array>

namespace rosflight::log {
namespace {

constexpr std::uint32_t kPolynomial = 0xEDB88320U;
using Tables = std::array<std::array<std::uint32_t, 256>, 8>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t c = byte;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1U) != 0 ? kPolynomial ^ (c >> 1U) : c >> 1U;
    tables[0][byte] = c;
  }
  for (std::size_t k = 1; k < tables.size(); ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t c = tables[k - 1][byte];
      tables[k][byte] = tables[0][c & 0xFFU] ^ (c >> 8U);
    }
  }
  return tables;
}

constexpr Tables kTables = make_tables();

}  // namespace

void Crc32::update(Bytes bytes) {
  std::uint32_t c = state_;
  while (bytes.size() >= 8) {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    std::memcpy(&low, bytes.data(), 4);
    std::memcpy(&high, bytes.data() + 4, 4);
    low ^= c;
    c = kTables[7][low & 0xFFU] ^ kTables[6][(low >> 8U) & 0xFFU] ^
        kTables[5][(low >> 16U) & 0xFFU] ^ kTables[4][low >> 24U] ^ kTables[3][high & 0xFFU] ^
        kTables[2][(high >> 8U) & 0xFFU] ^ kTables[1][(high >> 16U) & 0xFFU] ^
        kTables[0][high >> 24U];
    bytes = bytes.subspan(8);
  }
  for (const std::uint8_t byte : bytes) c = kTables[0][(c ^ byte) & 0xFFU] ^ (c >> 8U);
  state_ = c;
}

}  // namespace rosflight::log
