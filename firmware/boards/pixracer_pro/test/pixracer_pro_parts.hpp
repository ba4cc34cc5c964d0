// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/stm32h7/test/parts_under_test.hpp"

namespace rosflight::boards::stm32h7 {

/// BMI088: the filter of the gyro, 116 Hz, lets 30 rad/s decay to half a step within 22 ms, and the stamp lies 1.9 ms before
/// the edge; its temperature is read once in 1.28 s. 16 bits of 24 g and 2000 deg/s; temperature in steps of 0.125 K.
template <>
struct PartUnderTest<hal::ImuSample> : SteadyPart<hal::ImuSample> {
  static constexpr hal::Time kSettling{1'310'000}, kLatency{3'000}, kPeriod{1'000};
  static hal::ImuSample tolerance() {
    constexpr float kAccel_m_s2 = 0.51f * 24.0f * 9.80665f / 32'768.0f;
    constexpr float kGyro_rad_s = 0.51f * 2000.0f * 0.017453293f / 32'768.0f;
    return {{},
            {kAccel_m_s2, kAccel_m_s2, kAccel_m_s2},
            {kGyro_rad_s, kGyro_rad_s, kGyro_rad_s},
            0.0626f};
  }
};

/// IST8308: the stamp is the middle of 8 ms; 6.6 steps per microtesla, no temperature.
template <>
struct PartUnderTest<hal::MagSample> : SteadyPart<hal::MagSample> {
  static constexpr hal::Time kSettling{5'000}, kLatency{8'000}, kPeriod{10'000};
  static hal::MagSample expected(const hal::MagSample& exposure, hal::Time /*after*/) {
    return {exposure.stamp, exposure.field_T, 0.0f};
  }
  static hal::MagSample tolerance() {
    constexpr float kField_T = 0.51e-6f / 6.6f;
    return {{}, {kField_T, kField_T, kField_T}, 0.0f};
  }
};

/// MS4525DO: the middle of five readings 2 ms apart, each of which gives what was measured at the one before. 14 bits, of
/// which 80 % are 2 psi: 1.05 Pa; temperature in steps of 0.098 K.
template <>
struct PartUnderTest<hal::DiffPressureSample> : SteadyPart<hal::DiffPressureSample> {
  static constexpr hal::Time kSettling{7'500}, kLatency{6'500}, kPeriod{10'000};
  static hal::DiffPressureSample tolerance() {
    return {{}, 0.51f * 6894.76f / 6553.2f, 0.51f * 200.0f / 2047.0f};
  }
};

/// Divider 12.62, 60.5 A/V above 0.0747 V; exposed to 32 V and 22 A at most.
template <>
struct PartUnderTest<hal::BatterySample> : ConverterUnderTest {
  static hal::BatterySample tolerance() {
    return {{}, 12.62f * of_pin_V(32.0f / 12.62f), 60.5f * of_pin_V(22.0f / 60.5f + 0.0747f)};
  }
};

}  // namespace rosflight::boards::stm32h7
