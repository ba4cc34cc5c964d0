// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

/// The checksum of a lean frame: CRC-16/KERMIT, that is x^16 + x^12 + x^5 + 1, reflected, starting
/// from 0 (catalogue of parametrised CRC algorithms, G. Cook; check value 0x2189). Starting from 0
/// is safe here: a frame begins with its id, which is not 0, and the id determines its length.
///
/// By tables, eight bytes at a step: table k holds what a byte leaves behind after k more bytes, so
/// the bytes of a step are looked up side by side and their results added. Only the first two of
/// them have to wait for the step before. 4 kB of constants, 21 instructions a step on x86-64.
/// ("Slicing": Kounavis & Berry, IEEE Trans. Computers 57(11), 2008, section 4.)
namespace rosflight::link::lean {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "frames are read and written in place");

inline constexpr std::size_t kSlices = 8;

using ChecksumTable = std::array<std::uint16_t, 256>;

/// Table k holds the remainder of each byte followed by k zero bytes.
constexpr std::array<ChecksumTable, kSlices> make_checksum_tables() {
  constexpr unsigned kReflectedPolynomial = 0x8408;
  std::array<ChecksumTable, kSlices> tables{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    unsigned crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) * kReflectedPolynomial);
    tables[0][byte] = static_cast<std::uint16_t>(crc);
  }
  for (std::size_t k = 1; k < kSlices; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const unsigned crc = tables[k - 1][byte];
      tables[k][byte] = static_cast<std::uint16_t>((crc >> 8) ^ tables[0][crc & 0xFFu]);
    }
  }
  return tables;
}
inline constexpr std::array<ChecksumTable, kSlices> kChecksumTables = make_checksum_tables();

/// CRC of data[0, size). Inline, because its first step folds away if size is constant.
[[gnu::always_inline]] inline std::uint16_t checksum(const std::uint8_t* data, std::size_t size) {
  const auto& t = kChecksumTables;
  const std::size_t odd = size % kSlices;
  unsigned crc = 0;
  if (odd > 0) crc ^= t[odd - 1][data[0]];
  if (odd > 1) crc ^= t[odd - 2][data[1]];
  if (odd > 2) crc ^= t[odd - 3][data[2]];
  if (odd > 3) crc ^= t[odd - 4][data[3]];
  if (odd > 4) crc ^= t[odd - 5][data[4]];
  if (odd > 5) crc ^= t[odd - 6][data[5]];
  if (odd > 6) crc ^= t[odd - 7][data[6]];
  const std::uint8_t* const end = data + size;
  for (data += odd; data != end; data += kSlices) {
    std::uint16_t first = 0;
    std::memcpy(&first, data, sizeof first);
    crc ^= first;
    crc = t[7][crc & 0xFFu] ^ t[6][crc >> 8] ^ t[5][data[2]] ^ t[4][data[3]] ^ t[3][data[4]] ^
          t[2][data[5]] ^ t[1][data[6]] ^ t[0][data[7]];
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace rosflight::link::lean
