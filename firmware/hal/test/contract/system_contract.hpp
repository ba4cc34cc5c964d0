// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <gtest/gtest.h>

#include <cstring>

#include "firmware/hal/roles.hpp"

/// What a System promises. Instantiate with
///
///     struct Traits {
///       hal::System& role();          // the processor has just started
///       bool sensors_started() const;
///       bool reset_asked() const;
///       bool bootloader_asked() const;
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(Board, SystemContract, Traits);
///
/// reset() of a real processor does not return. Its test is run again behind the reset, with a role() whose
/// reset() returns, and with Traits that report what has happened.
namespace rosflight::hal::contract {

template <class Traits>
class SystemContract : public ::testing::Test {
 protected:
  Traits traits_;
};
TYPED_TEST_SUITE_P(SystemContract);

TYPED_TEST_P(SystemContract, StartsSensorsWhenAskedAndNotBefore) {
  EXPECT_FALSE(this->traits_.sensors_started());
  this->traits_.role().start_sensors();
  EXPECT_TRUE(this->traits_.sensors_started());
}

TYPED_TEST_P(SystemContract, ItsStartReportEnds) {
  this->traits_.role().start_sensors();
  std::size_t count = 0;
  bool ok = false;
  while (const char* text = this->traits_.role().sensor_message(count, ok)) {
    EXPECT_GT(std::strlen(text), 0u);
    ASSERT_LT(++count, 100u);
  }
  for (std::size_t beyond = count; beyond < count + 5; ++beyond) {
    EXPECT_EQ(this->traits_.role().sensor_message(beyond, ok), nullptr);
  }
}

TYPED_TEST_P(SystemContract, BadNewsInTheReportAreCountedAsErrors) {
  this->traits_.role().start_sensors();
  bool ok = true;
  std::uint16_t bad = 0;
  for (std::size_t k = 0; this->traits_.role().sensor_message(k, ok) != nullptr; ++k) {
    if (!ok) ++bad;
  }
  EXPECT_GE(this->traits_.role().sensor_errors(), bad);
}

TYPED_TEST_P(SystemContract, ResetsOnlyWhenAsked) {
  for (int k = 0; k < 10; ++k) this->traits_.role().feed_watchdog();
  EXPECT_FALSE(this->traits_.reset_asked());
  this->traits_.role().reset(false);
  EXPECT_TRUE(this->traits_.reset_asked());
  EXPECT_FALSE(this->traits_.bootloader_asked());
}

TYPED_TEST_P(SystemContract, ResetsIntoTheBootloaderWhenAsked) {
  this->traits_.role().reset(true);
  EXPECT_TRUE(this->traits_.reset_asked());
  EXPECT_TRUE(this->traits_.bootloader_asked());
}

TYPED_TEST_P(SystemContract, ProcessorTimeNeverDecreases) {
  Time last = this->traits_.role().busy_time();
  const bool shared = this->traits_.role().shares_processor();
  for (int k = 0; k < 100; ++k) {
    this->traits_.role().feed_watchdog();
    const Time now = this->traits_.role().busy_time();
    EXPECT_GE(now, last);
    last = now;
  }
  EXPECT_EQ(this->traits_.role().shares_processor(), shared);
}

REGISTER_TYPED_TEST_SUITE_P(SystemContract, StartsSensorsWhenAskedAndNotBefore, ItsStartReportEnds,
                            BadNewsInTheReportAreCountedAsErrors, ResetsOnlyWhenAsked,
                            ResetsIntoTheBootloaderWhenAsked, ProcessorTimeNeverDecreases);

}  // namespace rosflight::hal::contract
