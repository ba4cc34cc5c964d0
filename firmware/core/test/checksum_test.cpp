// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/checksum.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace rosflight::core {
namespace {

std::vector<std::uint8_t> bytes(const std::string& text) {
  return {text.begin(), text.end()};
}

std::uint32_t crc32(const std::string& text) {
  Crc32 crc;
  const auto data = bytes(text);
  crc.add(data.data(), data.size());
  return crc.value();
}

std::uint16_t fletcher(const std::string& text) {
  const auto data = bytes(text);
  return fletcher16(data.data(), data.size());
}

// Check value of the catalogue of parametrised CRC algorithms ("CRC-32/ISO-HDLC"); the others are
// what zlib's crc32() gives.
TEST(Crc32, MatchesPublishedValues) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926u);
  EXPECT_EQ(crc32(""), 0x00000000u);
  EXPECT_EQ(crc32("a"), 0xE8B7BE43u);
  EXPECT_EQ(crc32("abc"), 0x352441C2u);
  EXPECT_EQ(crc32("The quick brown fox jumps over the lazy dog"), 0x414FA339u);
}

TEST(Crc32, DoesNotDependOnHowTheDataArrive) {
  const auto data = bytes("123456789");
  for (std::size_t cut = 0; cut <= data.size(); ++cut) {
    Crc32 crc;
    crc.add(data.data(), cut);
    crc.add(data.data() + cut, data.size() - cut);
    EXPECT_EQ(crc.value(), 0xCBF43926u) << cut;
  }
}

// Published examples of Fletcher-16 (modulo 255, both sums from 0) are C8F0, 2057 and 0627 with the
// second sum high; ROSflight's crash record puts the first sum there.
TEST(Fletcher16, MatchesPublishedValues) {
  EXPECT_EQ(fletcher("abcde"), 0xF0C8u);
  EXPECT_EQ(fletcher("abcdef"), 0x5720u);
  EXPECT_EQ(fletcher("abcdefgh"), 0x2706u);
}

TEST(Fletcher16, PutsTheFirstSumHighOrLowAsTheCrashRecordWants) {
  // {1}: first sum 1, second sum 1. {1, 2}: 3 and 4. The record holds first * 256 + second.
  const std::array<std::uint8_t, 2> data{1, 2};
  EXPECT_EQ(fletcher16(data.data(), 1), 0x0101u);
  EXPECT_EQ(fletcher16(data.data(), 2), 0x0304u);
}

TEST(Fletcher16, NeverIsZeroSoThatBlankMemoryDoesNotCheck) {
  const std::array<std::uint8_t, 40> zeros{};
  EXPECT_EQ(fletcher16(zeros.data(), zeros.size()), 0xFFFFu);
  const std::array<std::uint8_t, 1> full{255};  // 255 is 0 modulo 255
  EXPECT_EQ(fletcher16(full.data(), full.size()), 0xFFFFu);
}

}  // namespace
}  // namespace rosflight::core
