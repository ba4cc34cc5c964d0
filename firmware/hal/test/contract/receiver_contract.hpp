// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/test/contract/delivery.hpp"

/// What a Receiver promises beyond being a Source (source_contract.hpp). Instantiate with
///
///     struct Traits {
///       using Sample = hal::RcFrame;
///       hal::Receiver& role();
///       void deliver(const hal::RcFrame& frame);
///     };                                      // and what delivery.hpp adds
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, ReceiverContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class ReceiverContract : public Delivery<Traits> {
 protected:
  ::testing::AssertionResult frame_passes(int k) {
    this->traits_.deliver(make<RcFrame>(k));
    RcFrame frame;
    if (!this->traits_.role().poll(frame)) return ::testing::AssertionFailure() << "no frame";
    return this->shows(frame, make<RcFrame>(k));
  }
};
TYPED_TEST_SUITE_P(ReceiverContract);

TYPED_TEST_P(ReceiverContract, StartsWithAtLeastOneType) {
  const bool ppm = this->traits_.role().start(ReceiverType::kPpm);
  const bool sbus = this->traits_.role().start(ReceiverType::kSbus);
  EXPECT_TRUE(ppm || sbus);
}

TYPED_TEST_P(ReceiverContract, MayBeStartedAgainAndKeepsReceivingEvenIfRefused) {
  int k = 0;
  for (const ReceiverType type :
       {ReceiverType::kPpm, ReceiverType::kSbus, ReceiverType::kPpm, ReceiverType::kSbus}) {
    static_cast<void>(this->traits_.role().start(type));
    EXPECT_TRUE(this->frame_passes(++k));
  }
}

TYPED_TEST_P(ReceiverContract, FlaggedFramesArePassedOnWithTheirFlags) {
  static_cast<void>(this->traits_.role().start(ReceiverType::kSbus));
  for (int flags = 0; flags < 4; ++flags) {
    RcFrame sent = make<RcFrame>(flags + 1);
    sent.frame_lost = (flags & 1) != 0;
    sent.failsafe = (flags & 2) != 0;
    this->traits_.deliver(sent);
    RcFrame frame;
    ASSERT_TRUE(this->traits_.role().poll(frame));
    EXPECT_EQ(frame.frame_lost, sent.frame_lost);
    EXPECT_EQ(frame.failsafe, sent.failsafe);
    EXPECT_LE(frame.channel_count, RcFrame::kMaxChannels);
  }
}

REGISTER_TYPED_TEST_SUITE_P(ReceiverContract, StartsWithAtLeastOneType,
                            MayBeStartedAgainAndKeepsReceivingEvenIfRefused,
                            FlaggedFramesArePassedOnWithTheirFlags);

}  // namespace rosflight::hal::contract
