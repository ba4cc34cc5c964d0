// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include "firmware/hal/roles.hpp"
#include "firmware/hal/test/contract/delivery.hpp"

/// What a Battery promises beyond being a Source (source_contract.hpp). Instantiate with
///
///     struct Traits {
///       using Sample = hal::BatterySample;
///       hal::Battery& role();
///       void deliver(const hal::BatterySample& pins);   // what the pins show, before any scale
///     };                                                // and what delivery.hpp adds; tolerance() is
///                                                       // that of the pins
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, BatteryContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class BatteryContract : public Delivery<Traits> {
 protected:
  BatterySample reading(float voltage_V, float current_A) {
    ++count_;
    this->traits_.deliver({milliseconds(count_), voltage_V, current_A});
    BatterySample sample{};
    EXPECT_TRUE(this->poll_delivered(sample));
    return sample;
  }
  /// Reading of 1 V and 1 A at the pins: the scales themselves.
  BatterySample scales() { return reading(1.0f, 1.0f); }

  void expect_same(const BatterySample& found, const BatterySample& before) {
    expect_voltage_scale(found, before.voltage_V);
    expect_current_scale(found, before.current_A);
    if constexpr (!kHasResolution<Traits>) {
      EXPECT_EQ(found.voltage_V, before.voltage_V);
      EXPECT_EQ(found.current_A, before.current_A);
    }
  }
  void expect_voltage_scale(const BatterySample& found, float scale, float pin = 1.0f) {
    expect_scaled(found.voltage_V, pin, scale, &BatterySample::voltage_V);
  }
  void expect_current_scale(const BatterySample& found, float scale, float pin = 1.0f) {
    expect_scaled(found.current_A, pin, scale, &BatterySample::current_A);
  }

 private:
  void expect_scaled(float found, float pin, float scale,
                     [[maybe_unused]] float BatterySample::*field) {
    if constexpr (kHasResolution<Traits>) {
      EXPECT_NEAR(found, scale * pin, scale * this->traits_.tolerance().*field);
    } else {
      EXPECT_FLOAT_EQ(found, scale * pin);
    }
  }

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
  this->expect_same(this->scales(), own);

  this->traits_.role().set_multipliers(11.0f, 0.0f);
  this->expect_same(this->scales(), {{}, 11.0f, own.current_A});

  this->traits_.role().set_multipliers(0.0f, 60.5f);
  this->expect_voltage_scale(this->scales(), 11.0f);
  this->expect_current_scale(this->scales(), 60.5f);

  this->traits_.role().set_multipliers(12.5f, 50.0f);
  this->expect_voltage_scale(this->scales(), 12.5f);
  this->expect_current_scale(this->scales(), 50.0f);
}

TYPED_TEST_P(BatteryContract, ScalesAreFactors) {
  this->traits_.role().set_multipliers(2.0f, 3.0f);
  const BatterySample sample = this->reading(2.25f, 0.5f);
  this->expect_voltage_scale(sample, 2.0f, 2.25f);
  this->expect_current_scale(sample, 3.0f, 0.5f);
  if constexpr (!kHasResolution<
                    TypeParam>) {  // which is a converter, with neither sign nor such voltages
    const BatterySample beyond = this->reading(8.25f, -0.5f);
    EXPECT_FLOAT_EQ(beyond.voltage_V, 16.5f);
    EXPECT_FLOAT_EQ(beyond.current_A, -1.5f);
  }
}

REGISTER_TYPED_TEST_SUITE_P(BatteryContract, HasScalesOfItsOwn,
                            TakesEachScaleByItselfAndZeroKeepsTheOneInForce, ScalesAreFactors);

}  // namespace rosflight::hal::contract
