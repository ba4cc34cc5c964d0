// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "link/mavlink/checksum.hpp"

namespace rosflight::link::mavlink {
namespace {

/// The definition: reflected polynomial 0x8408, start 0xFFFF, one bit at a time.
std::uint16_t by_definition(const std::vector<std::uint8_t>& data, std::uint8_t extra) {
  std::uint32_t crc = 0xFFFF;
  const auto eat = [&](std::uint8_t byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1u) != 0 ? 0x8408u : 0u);
  };
  for (const std::uint8_t byte : data) eat(byte);
  eat(extra);
  return static_cast<std::uint16_t>(crc);
}

TEST(Checksum, HasTheCheckValueOfCrc16Mcrf4xx) {
  // Check value of "123456789" in the catalogue of parametrised CRC algorithms (G. Cook).
  const std::vector<std::uint8_t> digits{'1', '2', '3', '4', '5', '6', '7', '8'};
  EXPECT_EQ(by_definition(digits, '9'), 0x6F91);
  EXPECT_EQ(checksum_by_bytes(digits.data(), digits.size(), '9'), 0x6F91);
  EXPECT_EQ(checksum_by<std::uint64_t>(digits.data(), digits.size(), '9'), 0x6F91);
  EXPECT_EQ(checksum_by<std::uint32_t>(digits.data(), digits.size(), '9'), 0x6F91);
}

TEST(Checksum, IsTheSameByBytesAndByWordsForEverySizeOfAFrame) {
  std::mt19937_64 random(1);
  for (std::size_t size = 0; size <= 260; ++size) {
    for (int run = 0; run < 20; ++run) {
      std::vector<std::uint8_t> data(size);
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      const auto extra = static_cast<std::uint8_t>(random());
      const std::uint16_t expected = by_definition(data, extra);
      ASSERT_EQ(checksum_by_bytes(data.data(), size, extra), expected) << size;
      ASSERT_EQ(checksum(data.data(), size, extra), expected) << size;
      if (size >= 4) {
        ASSERT_EQ(checksum_by<std::uint32_t>(data.data(), size, extra), expected) << size;
      }
    }
  }
}

}  // namespace
}  // namespace rosflight::link::mavlink
