// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/hal/roles.hpp"

/// What Outputs promise. Instantiate with
///
///     struct Traits {
///       hal::Outputs& role();
///       std::size_t channels() const;           // pins there are, 1..14
///       float resolution() const;               // of a value, 0 if exact
///       float driven(std::size_t k);            // value 0..1 that pin k is driven with; 0: no
///       pulses, or a low level; 1: also a high level
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, OutputsContract, Traits);
namespace rosflight::hal::contract {

template <class Traits>
class OutputsContract : public ::testing::Test {
 protected:
  static OutputRates all(float rate_hz) {
    OutputRates rates;
    rates.fill(rate_hz);
    return rates;
  }
  static OutputValues values(float value) {
    OutputValues out;
    out.fill(value);
    return out;
  }
  void expect_driven(float value) {
    for (std::size_t k = 0; k < traits_.channels(); ++k) {
      EXPECT_NEAR(traits_.driven(k), value, traits_.resolution()) << "pin " << k;
    }
  }
  /// Looks at the pins that have a rate, which is 0.
  void expect_levels(float level) {
    for (std::size_t k = 0; k < std::min(traits_.channels(), kRatedOutputs); ++k) {
      EXPECT_EQ(traits_.driven(k), level) << "pin " << k;
    }
  }
  void SetUp() override { ASSERT_TRUE(traits_.role().configure(all(50.0f))); }
  Traits traits_;
};
TYPED_TEST_SUITE_P(OutputsContract);

TYPED_TEST_P(OutputsContract, DrivesNothingBeforeTheFirstWrite) {
  this->expect_driven(0.0f);
}

TYPED_TEST_P(OutputsContract, DrivesEachPinWithItsOwnValue) {
  OutputValues values{};
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = 0.05f * static_cast<float>(k + 1);
  this->traits_.role().write(values);
  for (std::size_t k = 0; k < this->traits_.channels(); ++k) {
    EXPECT_NEAR(this->traits_.driven(k), values[k], this->traits_.resolution());
  }
}

TYPED_TEST_P(OutputsContract, ClampsToTheirRange) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const float low : {-0.001f, -5.0f, -kInf}) {
    this->traits_.role().write(this->values(low));
    this->expect_driven(0.0f);
  }
  for (const float high : {1.001f, 5.0f, kInf}) {
    this->traits_.role().write(this->values(high));
    this->expect_driven(1.0f);
  }
}

TYPED_TEST_P(OutputsContract, NotANumberStopsAPin) {
  this->traits_.role().write(this->values(0.75f));
  this->traits_.role().write(this->values(std::nanf("")));
  this->expect_driven(0.0f);
}

TYPED_TEST_P(OutputsContract, StayOffAfterDisableUntilConfiguredAgain) {
  this->traits_.role().write(this->values(0.75f));
  this->traits_.role().disable();
  this->expect_driven(0.0f);
  this->traits_.role().write(this->values(0.75f));
  this->expect_driven(0.0f);
  ASSERT_TRUE(this->traits_.role().configure(this->all(50.0f)));
  this->traits_.role().write(this->values(0.25f));
  this->expect_driven(0.25f);
}

TYPED_TEST_P(OutputsContract, CanBeConfiguredAgainAtRunTime) {
  this->traits_.role().write(this->values(0.5f));
  EXPECT_TRUE(this->traits_.role().configure(this->all(490.0f)));
  this->traits_.role().write(this->values(0.5f));
  this->expect_driven(0.5f);
}

TYPED_TEST_P(OutputsContract, ZeroRateMakesAPinALevel) {
  ASSERT_TRUE(this->traits_.role().configure(this->all(0.0f)));
  this->expect_levels(0.0f);
  for (const auto& [value, level] :
       {std::pair{0.5f, 1.0f}, {0.49f, 0.0f}, {7.0f, 1.0f}, {-1.0f, 0.0f}, {0.75f, 1.0f}}) {
    this->traits_.role().write(this->values(value));
    this->expect_levels(level);
  }
  this->traits_.role().write(this->values(std::nanf("")));
  this->expect_levels(0.0f);
  this->traits_.role().write(this->values(1.0f));
  this->traits_.role().disable();
  this->expect_driven(0.0f);
  ASSERT_TRUE(this->traits_.role().configure(this->all(50.0f)));
  this->traits_.role().write(this->values(0.75f));
  this->expect_driven(0.75f);
}

TYPED_TEST_P(OutputsContract, ALevelFitsAnyRateOfTheOtherPins) {
  for (const std::size_t level : {0u, 2u, 5u}) {
    OutputRates rates = this->all(490.0f);
    rates[level] = 0.0f;
    ASSERT_TRUE(this->traits_.role().configure(rates));
    for (const float value : {0.25f, 0.75f}) {
      this->traits_.role().write(this->values(value));
      for (std::size_t k = 0; k < this->traits_.channels(); ++k) {
        const float of_level = value < Outputs::kHighLevel ? 0.0f : 1.0f;
        EXPECT_NEAR(this->traits_.driven(k), k == level ? of_level : value,
                    this->traits_.resolution())
            << "pin " << k << ", level " << level;
      }
    }
  }
}

TYPED_TEST_P(OutputsContract, ReportsRatesThatItCannotGiveAndStillWorks) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  // Between the fastest pulses and the slowest DShot there is nothing.
  for (const float rate : {-50.0f, 1000.0f, 100'000.0f, kInf, std::nanf("")}) {
    EXPECT_FALSE(this->traits_.role().configure(this->all(rate))) << rate;
  }
  OutputRates one_bad = this->all(50.0f);
  one_bad[3] = 5000.0f;
  EXPECT_FALSE(this->traits_.role().configure(one_bad));
  this->traits_.role().write(this->values(0.5f));
  this->expect_driven(0.5f);
}

REGISTER_TYPED_TEST_SUITE_P(OutputsContract, DrivesNothingBeforeTheFirstWrite,
                            DrivesEachPinWithItsOwnValue, ClampsToTheirRange, NotANumberStopsAPin,
                            StayOffAfterDisableUntilConfiguredAgain, CanBeConfiguredAgainAtRunTime,
                            ZeroRateMakesAPinALevel, ALevelFitsAnyRateOfTheOtherPins,
                            ReportsRatesThatItCannotGiveAndStillWorks);

}  // namespace rosflight::hal::contract
