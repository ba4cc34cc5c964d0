// SPDX-License-Identifier: BSD-3-Clause
// The functions of images, under other names, against those of this machine's library.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>
#include <vector>

#define strlen image_strlen
#define strncmp image_strncmp
#define memcmp image_memcmp
#define memmove image_memmove
#define memcpy image_memcpy
#define memset image_memset
#include "firmware/boards/stm32h7/small_strings.cpp"
#undef strlen
#undef strncmp
#undef memcmp
#undef memmove
#undef memcpy
#undef memset

namespace rosflight::boards::stm32h7 {
namespace {

using Bytes = std::vector<unsigned char>;

Bytes random_bytes(std::size_t count) {
  static std::mt19937 random{3};
  Bytes bytes(count);
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random());
  return bytes;
}

/// Every distance up to 20 forth and back, every length up to 40, at every place in a word.
TEST(SmallStrings, MovesBlocksThatOverlap) {
  constexpr std::size_t kSize = 100;
  for (std::size_t from = 20; from < 28; ++from) {
    for (std::size_t to = from - 20; to <= from + 20; ++to) {
      for (std::size_t count = 0; count <= 40; ++count) {
        Bytes found = random_bytes(kSize), expected = found;
        std::memmove(expected.data() + to, expected.data() + from, count);
        ASSERT_EQ(image_memmove(found.data() + to, found.data() + from, count), found.data() + to);
        ASSERT_EQ(found, expected) << from << " to " << to << ", " << count;
      }
    }
  }
}

/// Blocks of exactly their size, so that the sanitizer sees what lies beyond.
TEST(SmallStrings, CopiesAndFillsNothingBeyond) {
  for (std::size_t count = 0; count <= 70; ++count) {
    const Bytes source = random_bytes(count);
    Bytes found(count), expected(count);
    ASSERT_EQ(image_memcpy(found.data(), source.data(), count), found.data());
    ASSERT_EQ(found, source);
    for (const int value : {0, 1, 0xA5, 0x1FF, -1}) {
      if (count > 0) std::memset(expected.data(), value, count);
      ASSERT_EQ(image_memset(found.data(), value, count), found.data());
      ASSERT_EQ(found, expected);
    }
  }
}

int sign(int value) {
  return (value > 0 ? 1 : 0) - (value < 0 ? 1 : 0);
}

TEST(SmallStrings, ComparesAndMeasures) {
  const std::vector<std::string> texts{"",    "a",   "ab",   "abc",
                                       "abd", "ABC", "\xFF", "longer than a word"};
  for (const std::string& a : texts) {
    EXPECT_EQ(image_strlen(a.c_str()), a.size());
    for (const std::string& b : texts) {
      for (std::size_t count = 0; count <= 4; ++count) {
        EXPECT_EQ(sign(image_strncmp(a.c_str(), b.c_str(), count)),
                  sign(std::strncmp(a.c_str(), b.c_str(), count)));
      }
      const std::size_t both = std::min(a.size(), b.size());
      EXPECT_EQ(sign(image_memcmp(a.data(), b.data(), both)),
                sign(std::memcmp(a.data(), b.data(), both)));
    }
  }
}

}  // namespace
}  // namespace rosflight::boards::stm32h7
