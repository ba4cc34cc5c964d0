// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <numeric>

#include "firmware/hal/roles.hpp"

/// What a BackupMemory promises. Instantiate with
///
///     struct Traits {
///       hal::BackupMemory& role();   // the power has just come on; after reset() the memory again
///       void reset();                // the processor starts again, the power stays on
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, BackupMemoryContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class BackupMemoryContract : public ::testing::Test {
 protected:
  using Bytes = std::array<std::uint8_t, BackupMemory::kSize>;
  static Bytes counting(std::uint8_t first) {
    Bytes bytes{};
    std::iota(bytes.begin(), bytes.end(), first);
    return bytes;
  }
  Bytes all() {
    Bytes bytes = counting(200);
    EXPECT_TRUE(traits_.role().read(bytes.data(), bytes.size()));
    return bytes;
  }
  Traits traits_;
};
TYPED_TEST_SUITE_P(BackupMemoryContract);

TYPED_TEST_P(BackupMemoryContract, HoldsWhatWasWritten) {
  const auto bytes = this->counting(3);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  EXPECT_EQ(this->all(), bytes);
}

TYPED_TEST_P(BackupMemoryContract, ReadingChangesNothing) {
  const auto bytes = this->counting(3);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  EXPECT_EQ(this->all(), this->all());
}

TYPED_TEST_P(BackupMemoryContract, AShortWriteLeavesTheRest) {
  auto bytes = this->counting(3);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  const auto other = this->counting(100);
  ASSERT_TRUE(this->traits_.role().write(other.data(), 5));
  std::copy_n(other.begin(), 5, bytes.begin());
  EXPECT_EQ(this->all(), bytes);
}

TYPED_TEST_P(BackupMemoryContract, IsZeroOnceCleared) {
  const auto bytes = this->counting(3);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  this->traits_.role().clear();
  typename TestFixture::Bytes zero{};
  EXPECT_EQ(this->all(), zero);
}

TYPED_TEST_P(BackupMemoryContract, SurvivesAReset) {
  const auto bytes = this->counting(7);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  this->traits_.reset();
  EXPECT_EQ(this->all(), bytes);
}

TYPED_TEST_P(BackupMemoryContract, RefusesMoreThanItsSize) {
  const auto bytes = this->counting(3);
  ASSERT_TRUE(this->traits_.role().write(bytes.data(), bytes.size()));
  std::array<std::uint8_t, BackupMemory::kSize + 1> large{};
  EXPECT_FALSE(this->traits_.role().write(large.data(), large.size()));
  EXPECT_FALSE(this->traits_.role().read(large.data(), large.size()));
  EXPECT_EQ(this->all(), bytes);
}

REGISTER_TYPED_TEST_SUITE_P(BackupMemoryContract, HoldsWhatWasWritten, ReadingChangesNothing,
                            AShortWriteLeavesTheRest, IsZeroOnceCleared, SurvivesAReset,
                            RefusesMoreThanItsSize);

}  // namespace rosflight::hal::contract
