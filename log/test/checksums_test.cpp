// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "log/checksums.hpp"

namespace rosflight::log {
namespace {

std::string sha256(std::string_view text) {
  Sha256 hash;
  hash.update(as_bytes(text));
  return hash.hex();
}

TEST(Crc32, CheckValueOfTheCatalogue) {
  // "CRC-32/ISO-HDLC" in the catalogue of parametrised CRC algorithms.
  EXPECT_EQ(crc32(as_bytes("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
  EXPECT_EQ(crc32({}, 0xCBF43926U), 0xCBF43926U);
}

TEST(Crc32, PiecesGiveTheSameAsTheWholeAtEveryCut) {
  std::vector<std::uint8_t> bytes(61);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(k * 37);
  const Bytes all(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    EXPECT_EQ(crc32(all.subspan(cut), crc32(all.first(cut))), crc32(all)) << cut;
  }
}

TEST(Sha256, ExamplesOfTheStandard) {
  // FIPS 180-4 example values (csrc.nist.gov, "SHA256.pdf") and SHAVS short messages of 0 bytes.
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, PiecesGiveTheSameAsTheWholeAndTheDigestDoesNotEndTheStream) {
  Sha256 hash;
  hash.update(as_bytes("a"));
  EXPECT_EQ(hash.hex(), sha256("a"));
  hash.update({});
  hash.update(as_bytes("bc"));
  EXPECT_EQ(hash.hex(), sha256("abc"));
}

}  // namespace
}  // namespace rosflight::log
