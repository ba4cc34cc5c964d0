// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/test/contract/delivery.hpp"

/// What every Source (sensor or receiver) promises. Instantiate with
///
///     struct Traits {
///       using Sample = hal::ImuSample;        // of any kind in samples.hpp
///       hal::Source<Sample>& role();          // nothing waits in it
///       void deliver(const Sample& sample);   // the device has measured this; stamps only grow
///     };                                      // and what delivery.hpp adds for parts of a real board
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, SourceContract, Traits);
///
/// Both a mailbox (a newer sample replaces the waiting one) and a queue keep this contract; one that is full gives
/// up an older sample, not the newest.
namespace rosflight::hal::contract {

template <class Traits>
class SourceContract : public Delivery<Traits> {
 protected:
  using Measurement = typename Traits::Sample;
  static constexpr int kRow = 100;  ///< So many samples in a row.

  /// Each sample is polled before the next is delivered.
  void take_a_row_of_deliveries() {
    for (int k = 1; k <= kRow; ++k) {
      this->traits_.deliver(make<Measurement>(k));
      Measurement sample{};
      ASSERT_TRUE(this->traits_.role().poll(sample));
      ASSERT_TRUE(this->shows(sample, make<Measurement>(k)));
      ASSERT_FALSE(this->traits_.role().poll(sample));
    }
  }

  /// The device measures at its own rate, and none of its samples is missing.
  void take_a_row_of_measurements() {
    this->traits_.deliver(make<Measurement>(1));
    Measurement sample{};
    ASSERT_TRUE(this->poll_delivered(sample));
    Time last = sample.stamp;
    for (int taken = 0, polls = 0; taken < kRow; ++polls) {
      ASSERT_LT(polls, 20 * kRow) << "only " << taken << " samples";
      if (!this->traits_.role().poll(sample)) {
        this->traits_.pass(this->traits_.period() / 8);
        continue;
      }
      ++taken;
      ASSERT_GT(sample.stamp, last);
      ASSERT_LT(2 * (sample.stamp - last), 3 * this->traits_.period());
      last = sample.stamp;
    }
  }
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
  ASSERT_TRUE(this->poll_delivered(sample));
  EXPECT_TRUE(this->shows(sample, measured));
  this->expect_no_more(sample.stamp);
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
  EXPECT_TRUE(this->shows(sample, make<Sample>(kNewest)));
}

TYPED_TEST_P(SourceContract, KeepsUpWithSampleAfterSample) {
  if constexpr (kMeasuresByItself<TypeParam>) {
    this->take_a_row_of_measurements();
  } else {
    this->take_a_row_of_deliveries();
  }
}

REGISTER_TYPED_TEST_SUITE_P(SourceContract, HasNothingBeforeTheFirstSampleAndLeavesTheCallersAlone,
                            GivesASampleOnceAndWhole, GivesTheNewestOfManyLastAndNothingTwice,
                            KeepsUpWithSampleAfterSample);

}  // namespace rosflight::hal::contract
