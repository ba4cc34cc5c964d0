// SPDX-License-Identifier: BSD-3-Clause
#include "web/server/byte_range.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace rosflight::web::server {
namespace {

using Pair = std::pair<std::uint64_t, std::uint64_t>;

std::optional<Pair> range(std::string_view header, std::uint64_t size) {
  const auto found = byte_range(header, size);
  return found ? std::optional<Pair>({found->start, found->length}) : std::nullopt;
}

// The examples of RFC 9110, section 14.1.2, for a file of 10 000 bytes.
TEST(ByteRange, ExamplesOfTheStandard) {
  EXPECT_EQ(range("bytes=0-499", 10000), Pair(0, 500));
  EXPECT_EQ(range("bytes=500-999", 10000), Pair(500, 500));
  EXPECT_EQ(range("bytes=-500", 10000), Pair(9500, 500));
  EXPECT_EQ(range("bytes=9500-", 10000), Pair(9500, 500));
}

TEST(ByteRange, IsShortenedToTheFile) {
  EXPECT_EQ(range("bytes=9990-20000", 10000), Pair(9990, 10));
  EXPECT_EQ(range("bytes=-20000", 10000), Pair(0, 10000));
  EXPECT_EQ(range("bytes=0-18446744073709551615", 10000), Pair(0, 10000));
}

TEST(ByteRange, IsShortenedToWhatOneAnswerMayHold) {
  EXPECT_EQ(range("bytes=5-", kMaxRange + 10), Pair(5, kMaxRange));
}

TEST(ByteRange, AnythingElseIsNone) {
  for (const char* header : {"", "bytes", "bytes=", "bytes=-", "bytes=-0", "bytes=5", "bytes=9-8",
                             "bytes=10000-", "bytes=0-1,3-4", "bytes=+1-2", "bytes=a-b",
                             "bytes=1-2x", "lines=1-2", "bytes=18446744073709551616-"}) {
    EXPECT_EQ(range(header, 10000), std::nullopt) << header;
  }
  EXPECT_EQ(range("bytes=0-0", 0), std::nullopt);
  EXPECT_EQ(range("bytes=-1", 0), std::nullopt);
}

}  // namespace
}  // namespace rosflight::web::server
