// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "base/constants.hpp"
#include "firmware/hal/samples.hpp"

/// What a part makes of what it is exposed to, by its data sheet and without noise. A board specializes PartUnderTest for
/// each kind of sample:
///
///     kStart     until it measures, behind the start of the sensors
///     kSettling  a sample stamped so long after the exposure began shows nothing from before
///     kLatency   longest, from a stamp until the main loop can have the sample
///     kPeriod    between two samples
///     expected(exposure, after)  what a sample shows that is stamped `after` the exposure began
///     tolerance()                half a step of the part, and rounding in single precision
namespace rosflight::boards::stm32h7 {

template <class Sample>
struct PartUnderTest;

/// Shows what it is exposed to.
template <class Sample>
struct SteadyPart {
  static constexpr hal::Time kStart{0};
  static Sample expected(const Sample& exposure, hal::Time /*after*/) { return exposure; }
};

/// DPS310 on either board. Temperature and pressure are measured in turn, 3.6 and 14.8 ms, and read in the tick that
/// follows; the stamp is the middle of the pressure's. One step of the pressure is 0.007 Pa and of the temperature
/// 0.0005 K, which is 0.006 Pa; a number of single precision at 1e5 Pa is exact to 0.004 Pa, and three are added.
struct Dps310UnderTest : SteadyPart<hal::BaroSample> {
  static constexpr hal::Time kSettling{14'000}, kLatency{10'000}, kPeriod{21'000};
  static hal::BaroSample tolerance() { return {{}, 0.03f, 1e-3f}; }
};

/// u-blox: ten solutions per second, each sent 60 ms after its time of validity in 9 ms. It is found at its rate and set up
/// within 2 s, and after 1 s more it has given a pulse, which dates its solutions. Steps of 1e-7 deg, 1 mm and 1 mm/s; the
/// pulse is dated within 100 us, because handlers of the bus context do not preempt one another.
struct UbloxUnderTest {
  static constexpr hal::Time kStart = hal::milliseconds(3500);
  static constexpr hal::Time kSettling{1'000}, kLatency{75'000}, kPeriod{100'000};

  /// The receiver moves on.
  static hal::GnssSample expected(const hal::GnssSample& exposure, hal::Time after) {
    constexpr double kMetresPerDegree = 111'319.49;  // of the equator of WGS-84
    constexpr std::int64_t kBillion = 1'000'000'000;
    const double dt_s = 1e-6 * static_cast<double>(after.count());
    const hal::Vec3& v = exposure.velocity_ned_m_s;
    hal::GnssSample s = exposure;
    s.latitude_deg += static_cast<double>(v[0]) * dt_s / kMetresPerDegree;
    s.longitude_deg += static_cast<double>(v[1]) * dt_s / kMetresPerDegree /
                       std::cos(exposure.latitude_deg * base::kRadPerDeg);
    s.height_msl_m = static_cast<float>(static_cast<double>(exposure.height_msl_m) -
                                        static_cast<double>(v[2]) * dt_s);
    const std::int64_t ns = exposure.unix_ns + 1000 * after.count();
    s.unix_s += ns / kBillion;
    s.unix_ns = static_cast<std::int32_t>(ns % kBillion);
    return s;
  }
  /// Half a step, and 100 us at 21 m/s: 2 mm.
  static hal::GnssSample tolerance() {
    hal::GnssSample s;
    s.fix = hal::GnssFix::kNone;
    s.unix_ns = 100'000;
    s.latitude_deg = s.longitude_deg = 0.5e-7 + 0.3e-7;
    s.height_msl_m = 0.5e-3f + 2e-3f + 2e-4f;
    s.velocity_ned_m_s = {0.51e-3f, 0.51e-3f, 0.51e-3f};
    s.horizontal_accuracy_m = s.vertical_accuracy_m = s.speed_accuracy_m_s = 0.51e-3f;
    return s;
  }
};

/// The converter of the chip, which measures two pins one after the other, ten times per second, each in a tick or two: half
/// a code of 16 bits of 3.3 V, and half a code of the reference that the supply is computed from, 1 of 24 069.
struct ConverterUnderTest : SteadyPart<hal::BatterySample> {
  static constexpr hal::Time kSettling{4'000}, kLatency{5'000}, kPeriod{100'000};
  static constexpr float of_pin_V(float pin_V) {
    return 0.5f * (3.3f / 65'535.0f) + 0.5f * pin_V / 24'069.0f;
  }
};
/// Tests of the scales show 2.25 V at most.
inline constexpr float kPinTolerance_V = ConverterUnderTest::of_pin_V(2.25f);

template <>
struct PartUnderTest<hal::BaroSample> : Dps310UnderTest {};
template <>
struct PartUnderTest<hal::GnssSample> : UbloxUnderTest {};

}  // namespace rosflight::boards::stm32h7
