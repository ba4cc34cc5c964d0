// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/test/contract/samples.hpp"

/// What every Source (sensor or receiver) promises. Instantiate with
///
///     struct Traits {
///       using Sample = hal::ImuSample;        // of any kind in samples.hpp
///       hal::Source<Sample>& role();          // nothing waits in it
///       void deliver(const Sample& sample);   // the device has measured this; stamps only grow
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, SourceContract, Traits);
///
/// Both a mailbox (a newer sample replaces the waiting one) and a queue keep this contract.
namespace rosflight::hal::contract {

template <class Traits>
class SourceContract : public ::testing::Test {
 protected:
  Traits traits_;
};
TYPED_TEST_SUITE_P(SourceContract);

TYPED_TEST_P(SourceContract, HasNothingBeforeTheFirstSampleAndLeavesTheCallersAlone) {
  using Sample = typename TypeParam::Sample;
  const Sample mine = make<Sample>(7);
  Sample sample = mine;
  EXPECT_FALSE(this->traits_.role().poll(sample));
  EXPECT_EQ(fields(sample), fields(mine));
}

TYPED_TEST_P(SourceContract, GivesASampleOnceAndWhole) {
  using Sample = typename TypeParam::Sample;
  const Sample measured = make<Sample>(1);
  this->traits_.deliver(measured);
  Sample sample = make<Sample>(9);
  ASSERT_TRUE(this->traits_.role().poll(sample));
  EXPECT_EQ(fields(sample), fields(measured));
  const Sample mine = make<Sample>(8);
  sample = mine;
  EXPECT_FALSE(this->traits_.role().poll(sample));
  EXPECT_EQ(fields(sample), fields(mine));
}

TYPED_TEST_P(SourceContract, GivesTheNewestOfManyLastAndNothingTwice) {
  using Sample = typename TypeParam::Sample;
  constexpr int kNewest = 20;
  for (int k = 1; k <= kNewest; ++k) this->traits_.deliver(make<Sample>(k));
  Sample sample{};
  Time last{};
  int count = 0;
  while (this->traits_.role().poll(sample)) {
    EXPECT_GT(sample.stamp, last);
    last = sample.stamp;
    ASSERT_LE(++count, kNewest);
  }
  EXPECT_EQ(fields(sample), fields(make<Sample>(kNewest)));
}

TYPED_TEST_P(SourceContract, KeepsUpWithSampleAfterSample) {
  using Sample = typename TypeParam::Sample;
  for (int k = 1; k <= 100; ++k) {
    this->traits_.deliver(make<Sample>(k));
    Sample sample{};
    ASSERT_TRUE(this->traits_.role().poll(sample));
    ASSERT_EQ(sample.stamp, milliseconds(k));
    ASSERT_FALSE(this->traits_.role().poll(sample));
  }
}

REGISTER_TYPED_TEST_SUITE_P(SourceContract, HasNothingBeforeTheFirstSampleAndLeavesTheCallersAlone,
                            GivesASampleOnceAndWhole, GivesTheNewestOfManyLastAndNothingTwice,
                            KeepsUpWithSampleAfterSample);

}  // namespace rosflight::hal::contract
