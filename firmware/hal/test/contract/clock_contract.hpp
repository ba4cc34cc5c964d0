// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"

/// What a Clock promises. Instantiate with
///
///     struct Traits {
///       hal::Clock& role();          // the processor has just started
///       void pass(hal::Time time);   // lets at least this much time go by (sleep, or set the
///       clock)
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, ClockContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class ClockContract : public ::testing::Test {
 protected:
  Traits traits_;
};
TYPED_TEST_SUITE_P(ClockContract);

TYPED_TEST_P(ClockContract, CountsFromBoot) {
  EXPECT_GE(this->traits_.role().now(), Time{0});
  // An hour is far more than any board needs to start and far less than a wall clock shows.
  EXPECT_LT(this->traits_.role().now(), milliseconds(3'600'000));
}

TYPED_TEST_P(ClockContract, NeverDecreases) {
  Time last = this->traits_.role().now();
  for (int k = 0; k < 1000; ++k) {
    const Time now = this->traits_.role().now();
    ASSERT_GE(now, last);
    last = now;
  }
}

TYPED_TEST_P(ClockContract, GoesOnByAtLeastTheTimeThatPasses) {
  Time last = this->traits_.role().now();
  for (const Time step : {microseconds(100), milliseconds(2), milliseconds(20)}) {
    this->traits_.pass(step);
    const Time now = this->traits_.role().now();
    EXPECT_GE(now - last, step);
    last = now;
  }
}

REGISTER_TYPED_TEST_SUITE_P(ClockContract, CountsFromBoot, NeverDecreases,
                            GoesOnByAtLeastTheTimeThatPasses);

}  // namespace rosflight::hal::contract
