// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "log/crc32.hpp"
#include "log/sha256.hpp"
#include "log/utf8.hpp"

namespace rosflight::log {
namespace {

std::string sha256(std::string_view text, Sha256::Compress compress) {
  Sha256 hash(compress);
  hash.update(as_bytes(text));
  return hash.hex();
}

TEST(Crc32, CheckValueOfTheCatalogue) {
  // "CRC-32/ISO-HDLC" in the catalogue of parametrised CRC algorithms.
  EXPECT_EQ(crc32(as_bytes("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}

TEST(Crc32, PiecesGiveTheSameAsTheWholeAtEveryCut) {
  std::vector<std::uint8_t> bytes(61);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(k * 37);
  const Bytes all(bytes);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    Crc32 crc;
    crc.update(all.first(cut));
    crc.update(all.subspan(cut));
    EXPECT_EQ(crc.value(), crc32(all)) << cut;
  }
}

class Sha256Implementation : public testing::TestWithParam<Sha256::Compress> {};
// The second is the first again on a processor without the instructions.
INSTANTIATE_TEST_SUITE_P(All, Sha256Implementation,
                         testing::Values(Sha256::compress_portable, Sha256::fastest()));

TEST_P(Sha256Implementation, ExamplesOfTheStandard) {
  // FIPS 180-4 example values (csrc.nist.gov, "SHA256.pdf") and SHAVS short messages of 0 bytes.
  EXPECT_EQ(sha256("abc", GetParam()),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", GetParam()),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256("", GetParam()),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a'), GetParam()),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_P(Sha256Implementation, PiecesGiveTheSameAsTheWholeAtEveryCut) {
  std::string text;
  for (int k = 0; k < 200; ++k) text += static_cast<char>('!' + k % 90);
  const std::string whole = sha256(text, Sha256::compress_portable);
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    Sha256 hash(GetParam());
    hash.update(as_bytes(std::string_view(text).substr(0, cut)));
    hash.update(as_bytes(std::string_view(text).substr(cut)));
    EXPECT_EQ(hash.hex(), whole) << cut;
  }
}

TEST_P(Sha256Implementation, PaddingFillsOneOrTwoBlocks) {
  // Made with coreutils sha256sum: 55, 56, 63, 64 and 119 times "x", around the edges of
  // section 5.1.1.
  const auto of = [&](std::size_t count) { return sha256(std::string(count, 'x'), GetParam()); };
  EXPECT_EQ(of(55), "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
  EXPECT_EQ(of(56), "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
  EXPECT_EQ(of(63), "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2");
  EXPECT_EQ(of(64), "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
  EXPECT_EQ(of(119), "000b48d4edf0fa7bee3c6236ecd2785baa5db4eeb8bb54341b029e0d9fa5fb0c");
}

TEST(Sha256, DigestDoesNotEndTheStream) {
  Sha256 hash;
  hash.update(as_bytes("a"));
  EXPECT_EQ(hash.hex(), sha256("a", Sha256::compress_portable));
  hash.update(as_bytes("bc"));
  EXPECT_EQ(hash.hex(), sha256("abc", Sha256::compress_portable));
}

TEST(CleanUtf8, KeepsGoodTextAndReplacesTheRest) {
  EXPECT_EQ(clean_utf8("a\tb\n\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x81"),
            "a\tb\n\xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x81");
  EXPECT_EQ(clean_utf8("a\x1B[31m\r\x7F"), "a?[31m??");
  EXPECT_EQ(clean_utf8("\xC0\xAF"), "??");            // Overlong.
  EXPECT_EQ(clean_utf8("\xED\xA0\x80"), "???");       // Surrogate.
  EXPECT_EQ(clean_utf8("\xF4\x90\x80\x80"), "????");  // Past U+10FFFF.
  EXPECT_EQ(clean_utf8("\xE2\x82"), "??");            // Cut short.
  EXPECT_EQ(clean_utf8(std::string_view("ab\0cd", 5)), "ab");
}

}  // namespace
}  // namespace rosflight::log
