// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/test/contract/samples.hpp"

/// What a Battery promises beyond being a Source (source_contract.hpp). Instantiate with
///
///     struct Traits {
///       using Sample = hal::BatterySample;
///       hal::Battery& role();
///       void deliver(const hal::BatterySample& pins);   // what the pins show, before any scale
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, BatteryContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class BatteryContract : public ::testing::Test {
 protected:
  /// Reading of 1 V and 1 A at the pins: the scales themselves.
  BatterySample scales() {
    ++count_;
    traits_.deliver({milliseconds(count_), 1.0f, 1.0f});
    BatterySample sample{};
    EXPECT_TRUE(traits_.role().poll(sample));
    return sample;
  }
  Traits traits_;

 private:
  int count_{0};
};
TYPED_TEST_SUITE_P(BatteryContract);

TYPED_TEST_P(BatteryContract, HasScalesOfItsOwn) {
  const BatterySample own = this->scales();
  EXPECT_GT(own.voltage_V, 0.0f);
  EXPECT_GT(own.current_A, 0.0f);
}

TYPED_TEST_P(BatteryContract, TakesEachScaleByItselfAndZeroKeepsTheOneInForce) {
  const BatterySample own = this->scales();
  this->traits_.role().set_multipliers(0.0f, 0.0f);
  EXPECT_EQ(this->scales().voltage_V, own.voltage_V);
  EXPECT_EQ(this->scales().current_A, own.current_A);

  this->traits_.role().set_multipliers(11.0f, 0.0f);
  EXPECT_FLOAT_EQ(this->scales().voltage_V, 11.0f);
  EXPECT_EQ(this->scales().current_A, own.current_A);

  this->traits_.role().set_multipliers(0.0f, 60.5f);
  EXPECT_FLOAT_EQ(this->scales().voltage_V, 11.0f);
  EXPECT_FLOAT_EQ(this->scales().current_A, 60.5f);

  this->traits_.role().set_multipliers(12.5f, 50.0f);
  EXPECT_FLOAT_EQ(this->scales().voltage_V, 12.5f);
  EXPECT_FLOAT_EQ(this->scales().current_A, 50.0f);
}

TYPED_TEST_P(BatteryContract, ScalesAreFactors) {
  this->traits_.role().set_multipliers(2.0f, 3.0f);
  this->traits_.deliver({milliseconds(1), 8.25f, -0.5f});
  BatterySample sample{};
  ASSERT_TRUE(this->traits_.role().poll(sample));
  EXPECT_FLOAT_EQ(sample.voltage_V, 16.5f);
  EXPECT_FLOAT_EQ(sample.current_A, -1.5f);
}

REGISTER_TYPED_TEST_SUITE_P(BatteryContract, HasScalesOfItsOwn,
                            TakesEachScaleByItselfAndZeroKeepsTheOneInForce, ScalesAreFactors);

}  // namespace rosflight::hal::contract
