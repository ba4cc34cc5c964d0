// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "firmware/hal/roles.hpp"

/// What a Storage promises. Instantiate with
///
///     struct Traits {
///       hal::Storage& role();   // at least 1024 bytes; after power_cycle() the same medium again
///       void power_cycle();     // power off and on, nothing being written
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, StorageContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class StorageContract : public ::testing::Test {
 protected:
  static std::vector<std::uint8_t> pattern(std::size_t count, std::size_t seed) {
    std::vector<std::uint8_t> bytes(count);
    for (std::size_t k = 0; k < count; ++k) {
      bytes[k] = static_cast<std::uint8_t>((k * 31 + seed * 17 + k / 256) & 0xFFu);
    }
    return bytes;
  }
  std::vector<std::uint8_t> read(std::size_t offset, std::size_t count) {
    std::vector<std::uint8_t> bytes(count);
    EXPECT_TRUE(traits_.role().read(offset, bytes.data(), count));
    return bytes;
  }
  void write(std::size_t offset, const std::vector<std::uint8_t>& bytes) {
    ASSERT_TRUE(traits_.role().write(offset, bytes.data(), bytes.size()));
    ASSERT_TRUE(traits_.role().flush());
  }
  Traits traits_;
};
TYPED_TEST_SUITE_P(StorageContract);

TYPED_TEST_P(StorageContract, HasTheSizeItSays) {
  const std::size_t size = this->traits_.role().size();
  ASSERT_GE(size, 1024u);
  const auto whole = this->pattern(size, 1);
  this->write(0, whole);
  EXPECT_EQ(this->read(0, size), whole);
}

TYPED_TEST_P(StorageContract, CanBeReadBeforeItWasWritten) {
  EXPECT_EQ(this->read(0, 64), this->read(0, 64));
}

TYPED_TEST_P(StorageContract, ChangesOnlyTheBytesThatAreWritten) {
  const std::size_t size = this->traits_.role().size();
  auto expected = this->pattern(size, 1);
  this->write(0, expected);
  // Odd offsets and lengths, across any page boundary there may be.
  for (const auto& [offset, count] : {std::pair<std::size_t, std::size_t>{1, 1},
                                      {63, 3},
                                      {255, 2},
                                      {500, 37},
                                      {511, 514},
                                      {size - 1, 1}}) {
    const std::size_t n = std::min(count, size - offset);
    const auto part = this->pattern(n, 9);
    this->write(offset, part);
    std::copy(part.begin(), part.end(), expected.begin() + static_cast<std::ptrdiff_t>(offset));
    EXPECT_EQ(this->read(0, size), expected) << offset;
  }
}

TYPED_TEST_P(StorageContract, ReadsWithinWhatWasWritten) {
  const auto whole = this->pattern(1024, 4);
  this->write(0, whole);
  for (std::size_t offset = 0; offset < 200; offset += 13) {
    EXPECT_EQ(this->read(offset, 100),
              std::vector<std::uint8_t>(whole.begin() + static_cast<std::ptrdiff_t>(offset),
                                        whole.begin() + static_cast<std::ptrdiff_t>(offset) + 100));
  }
}

TYPED_TEST_P(StorageContract, RefusesRangesThatLeaveItAndKeepsItsContents) {
  const std::size_t size = this->traits_.role().size();
  const auto whole = this->pattern(size, 2);
  this->write(0, whole);
  std::vector<std::uint8_t> buffer(64, 0xEE);
  constexpr std::size_t kHuge = std::numeric_limits<std::size_t>::max();
  for (const std::size_t offset : {size, size - 1, size - 63, size + 1, kHuge, kHuge - 63}) {
    EXPECT_FALSE(this->traits_.role().read(offset, buffer.data(), buffer.size())) << offset;
    buffer.assign(64, 0xEE);
    EXPECT_FALSE(this->traits_.role().write(offset, buffer.data(), buffer.size())) << offset;
  }
  EXPECT_EQ(this->read(0, size), whole);
}

TYPED_TEST_P(StorageContract, TakesTheLastBytesAndNothingAtAll) {
  const std::size_t size = this->traits_.role().size();
  const auto part = this->pattern(64, 6);
  this->write(size - 64, part);
  EXPECT_EQ(this->read(size - 64, 64), part);
  std::uint8_t byte = 0;
  EXPECT_TRUE(this->traits_.role().read(size, &byte, 0));
  EXPECT_TRUE(this->traits_.role().write(size, &byte, 0));
}

TYPED_TEST_P(StorageContract, SurvivesAPowerCycle) {
  const std::size_t size = this->traits_.role().size();
  const auto whole = this->pattern(size, 3);
  this->write(0, whole);
  this->traits_.power_cycle();
  EXPECT_EQ(this->traits_.role().size(), size);
  EXPECT_EQ(this->read(0, size), whole);
}

REGISTER_TYPED_TEST_SUITE_P(StorageContract, HasTheSizeItSays, CanBeReadBeforeItWasWritten,
                            ChangesOnlyTheBytesThatAreWritten, ReadsWithinWhatWasWritten,
                            RefusesRangesThatLeaveItAndKeepsItsContents,
                            TakesTheLastBytesAndNothingAtAll, SurvivesAPowerCycle);

}  // namespace rosflight::hal::contract
