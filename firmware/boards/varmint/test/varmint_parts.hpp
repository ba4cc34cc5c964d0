// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/test/parts_under_test.hpp"

namespace rosflight::boards::stm32h7 {

/// ADIS16500: five samples of 0.5 ms are averaged, the stamp is their middle and 2.51 ms before the edge. 32 bits, of which
/// single precision keeps 24, at 31 rad/s and 21 m/s2; temperature in steps of 0.1 K.
template <>
struct PartUnderTest<hal::ImuSample> : SteadyPart<hal::ImuSample> {
  static constexpr hal::Time kSettling{1'500}, kLatency{4'000}, kPeriod{2'500};
  static hal::ImuSample tolerance() {
    constexpr float kRounding = 4e-6f;
    return {{}, {kRounding, kRounding, kRounding}, {kRounding, kRounding, kRounding}, 0.0501f};
  }
};

/// IIS2MDC: the mean of two measurements of 10 ms, stamped in the middle of both; steps of 0.15 microtesla and 0.125 K.
template <>
struct PartUnderTest<hal::MagSample> : SteadyPart<hal::MagSample> {
  static constexpr hal::Time kSettling{12'000}, kLatency{13'000}, kPeriod{11'000};
  static hal::MagSample tolerance() {
    constexpr float kField_T = 0.51f * 0.15e-6f;
    return {{}, {kField_T, kField_T, kField_T}, 0.0626f};
  }
};

/// DLHR: the middle of 5.2 ms. 24 bits of 6227 Pa and of 125 K: single precision decides.
template <>
struct PartUnderTest<hal::DiffPressureSample> : SteadyPart<hal::DiffPressureSample> {
  static constexpr hal::Time kSettling{4'000}, kLatency{5'000}, kPeriod{10'000};
  static hal::DiffPressureSample tolerance() { return {{}, 1e-3f, 5e-5f}; }
};

/// Divider 11.215, 10 A/V; exposed to 32 V and 22 A at most.
template <>
struct PartUnderTest<hal::BatterySample> : ConverterUnderTest {
  static hal::BatterySample tolerance() {
    return {{}, 11.215f * of_pin_V(32.0f / 11.215f), 10.0f * of_pin_V(22.0f / 10.0f)};
  }
};

}  // namespace rosflight::boards::stm32h7
