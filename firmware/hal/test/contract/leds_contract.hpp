// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"

/// What Leds promise. Instantiate with
///
///     struct Traits {
///       hal::Leds& role();
///       bool lit(hal::Led led);   // what a person would see
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, LedsContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class LedsContract : public ::testing::Test {
 protected:
  Traits traits_;
};
TYPED_TEST_SUITE_P(LedsContract);

TYPED_TEST_P(LedsContract, AreDarkAtFirst) {
  EXPECT_FALSE(this->traits_.lit(Led::kOverride));
  EXPECT_FALSE(this->traits_.lit(Led::kStatus));
}

TYPED_TEST_P(LedsContract, GoOnAndOffOneWithoutTheOther) {
  for (const bool status : {true, true, false, true}) {
    for (const bool override_led : {true, false, false, true}) {
      this->traits_.role().set(Led::kStatus, status);
      this->traits_.role().set(Led::kOverride, override_led);
      EXPECT_EQ(this->traits_.lit(Led::kStatus), status);
      EXPECT_EQ(this->traits_.lit(Led::kOverride), override_led);
    }
  }
}

REGISTER_TYPED_TEST_SUITE_P(LedsContract, AreDarkAtFirst, GoOnAndOffOneWithoutTheOther);

}  // namespace rosflight::hal::contract
