// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/pulses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "firmware/boards/parts/battery_monitor.hpp"

namespace rosflight::boards::parts {
namespace {

constexpr std::uint32_t kTimer_hz = 200'000'000;
using Status = PulsePlan::Status;

PulsePlan plan(std::vector<float> rates) {
  return plan_pulses(rates.data(), rates.size(), kTimer_hz);
}

TEST(Pulses, EveryPwmRateIsMetWithinOneCountAndFitsSixteenBits) {
  for (int rate = 4; rate <= 490; ++rate) {
    const PulsePlan p = plan({static_cast<float>(rate)});
    ASSERT_EQ(p.status, Status::kOk);
    ASSERT_EQ(p.kind, PulseKind::kPwm);
    ASSERT_LE(p.period, 65'536u) << rate;
    ASSERT_LE(p.prescaler, 65'535u);
    const double count_s = (p.prescaler + 1.0) / kTimer_hz;
    EXPECT_NEAR(p.period * count_s, 1.0 / rate, count_s) << rate;
    for (const float value : {0.0f, 0.123f, 0.5f, 0.999f, 1.0f}) {
      const double pulse_s = 1e-3 + 1e-3 * static_cast<double>(value);
      EXPECT_NEAR(pwm_counts(p, value) * count_s, pulse_s, count_s) << rate << " " << value;
      EXPECT_LT(pwm_counts(p, value), p.period);
    }
  }
}

TEST(Pulses, FiftyHertzByHand) {
  // 200 MHz / 62 = 3.2258 MHz: 64 516.1 counts per period, 3225.8 counts per ms.
  const PulsePlan p = plan({50.0f, 0.0f, 50.0f});
  EXPECT_EQ(p.prescaler, 61u);
  EXPECT_EQ(p.period, 64'516u);
  EXPECT_EQ(pwm_counts(p, 0.0f), 3226u);
  EXPECT_EQ(pwm_counts(p, 1.0f), 6452u);
}

TEST(Pulses, ValuesAreLimitedAndNanIsTheShortestPulse) {
  const PulsePlan p = plan({400.0f});
  EXPECT_EQ(pwm_counts(p, -3.0f), pwm_counts(p, 0.0f));
  EXPECT_EQ(pwm_counts(p, 3.0f), pwm_counts(p, 1.0f));
  EXPECT_EQ(pwm_counts(p, std::numeric_limits<float>::quiet_NaN()), pwm_counts(p, 0.0f));
}

TEST(Pulses, RateZeroIsOffAndDividesNothing) {
  const PulsePlan p = plan({0.0f, 0.0f});
  EXPECT_EQ(p.status, Status::kOk);
  EXPECT_EQ(p.kind, PulseKind::kOff);
  EXPECT_EQ(p.period, 0u);
  EXPECT_EQ(plan({}).kind, PulseKind::kOff);
}

TEST(Pulses, MixedRatesOfOneTimerAreRefusedAndTheSlowestIsUsed) {
  EXPECT_EQ(plan({400.0f, 50.0f}).status, Status::kMixedRates);
  EXPECT_EQ(plan({400.0f, 50.0f}).rate_hz, 50.0f);
  EXPECT_EQ(plan({300'000.0f, 50.0f}).kind, PulseKind::kPwm);
  EXPECT_EQ(plan({300'000.0f, 600'000.0f}).status, Status::kMixedRates);
  EXPECT_EQ(plan({0.0f, 50.0f, 0.0f}).status, Status::kOk);
}

TEST(Pulses, RatesOutOfRangeAreRefused) {
  for (const float rate :
       {-1.0f, 3.0f, 491.0f, 149'999.0f, 1'200'001.0f, std::numeric_limits<float>::quiet_NaN(),
        std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(plan({rate}).status, Status::kOutOfRange) << rate;
    EXPECT_EQ(plan({rate}).kind, PulseKind::kOff);
    EXPECT_EQ(plan({rate, 50.0f}).rate_hz, 50.0f);
  }
}

// ---- DShot

TEST(Dshot, FramesAreThoseOfTheProtocol) {
  // Published example: throttle 1046, no telemetry: 1000 0010 1100 0110.
  EXPECT_EQ(dshot_frame(1046, false), 0b1000'0010'1100'0110);
  EXPECT_EQ(dshot_frame(0, false), 0x0000);
  EXPECT_EQ(dshot_frame(0, true), 0x0011);
  EXPECT_EQ(dshot_frame(2047, true), 0xFFFF);
  EXPECT_EQ(dshot_frame(48, false), 0x0606);
}

TEST(Dshot, TheChecksumMakesTheFourNibblesCancel) {
  for (unsigned throttle = 0; throttle < 2048; ++throttle) {
    for (const bool telemetry : {false, true}) {
      const unsigned frame = dshot_frame(static_cast<std::uint16_t>(throttle), telemetry);
      EXPECT_EQ((frame >> 12 ^ frame >> 8 ^ frame >> 4 ^ frame) & 0xFu, 0u);
      EXPECT_EQ(frame >> 5, throttle);
      EXPECT_EQ((frame >> 4 & 1u) != 0, telemetry);
    }
  }
}

TEST(Dshot, StoppedIsZeroAndRunningIs48To2047) {
  EXPECT_EQ(dshot_throttle(0.0f), 0);
  EXPECT_EQ(dshot_throttle(-1.0f), 0);
  EXPECT_EQ(dshot_throttle(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(dshot_throttle(1e-6f), 48);
  EXPECT_EQ(dshot_throttle(0.5f), 1048);
  EXPECT_EQ(dshot_throttle(1.0f), 2047);
  EXPECT_EQ(dshot_throttle(2.0f), 2047);
}

TEST(Dshot, PulseTrainsDecodeToTheirFrameAtEveryRate) {
  for (const float rate : {150'000.0f, 300'000.0f, 600'000.0f, 1'200'000.0f}) {
    const PulsePlan p = plan({rate});
    ASSERT_EQ(p.kind, PulseKind::kDshot);
    EXPECT_EQ(p.prescaler, 0u);
    EXPECT_NEAR(p.period, kTimer_hz / rate, 0.5001);
    for (unsigned frame = 0; frame < 65'536; frame += 257) {
      const auto counts = dshot_counts(static_cast<std::uint16_t>(frame), p.period);
      unsigned decoded = 0;
      for (std::size_t k = 0; k < 16; ++k) {
        const bool one = counts[k] * 16u > p.period * 9u;  // halfway between 6/16 and 12/16
        decoded = decoded << 1 | (one ? 1u : 0u);
        EXPECT_NEAR(counts[k], p.period * (one ? 0.75 : 0.375), 0.5001);
      }
      EXPECT_EQ(decoded, frame);
      EXPECT_EQ(counts[16], 0);
    }
  }
}

// ---- battery

TEST(BatteryMonitor, ScalesWithTheTableOfTheBoards) {
  // Pixracer Pro: voltage 12.62, current 60.5 with 0.0747 V of offset.
  BatteryMonitor battery{{12.62f, 0.0f}, {60.5f, 0.0747f}};
  hal::BatterySample sample;
  EXPECT_FALSE(battery.poll(sample));
  battery.measured(hal::milliseconds(5), 1.25f, 0.5747f);
  ASSERT_TRUE(battery.poll(sample));
  EXPECT_EQ(sample.stamp, hal::milliseconds(5));
  EXPECT_NEAR(sample.voltage_V, 15.775f, 1e-4f);
  EXPECT_NEAR(sample.current_A, 30.25f, 1e-3f);
  EXPECT_FALSE(battery.poll(sample));
}

TEST(BatteryMonitor, MultipliersReplaceTheScaleAndZeroKeepsTheOneInForce) {
  BatteryMonitor battery{{12.62f, 0.0f}, {60.5f, 0.1f}};
  hal::BatterySample sample;
  battery.set_multipliers(10.1f, 17.0f);
  battery.measured({}, 1.0f, 1.1f);
  ASSERT_TRUE(battery.poll(sample));
  EXPECT_NEAR(sample.voltage_V, 10.1f, 1e-5f);
  EXPECT_NEAR(sample.current_A, 17.0f, 1e-4f);
  battery.set_multipliers(0.0f, 0.0f);
  battery.measured({}, 1.0f, 1.1f);
  ASSERT_TRUE(battery.poll(sample));
  EXPECT_NEAR(sample.voltage_V, 10.1f, 1e-5f);
  EXPECT_NEAR(sample.current_A, 17.0f, 1e-4f);
}

TEST(Adc, ConvertsByTheReference) {
  // The reference reads 24 600 instead of 24 000: the supply is 3.2195 V.
  const AdcCalibration calibration{24'000.0f, 12'000.0f, 16'000.0f};
  const float supply = adc_supply_V(calibration, 24'600);
  EXPECT_NEAR(supply, 3.3f * 24'000.0f / 24'600.0f, 1e-5f);
  EXPECT_EQ(adc_supply_V(calibration, 0), 0.0f);
  EXPECT_NEAR(adc_pin_V(65'535, supply), supply, 1e-6f);
  EXPECT_NEAR(adc_pin_V(0, supply), 0.0f, 1e-6f);
  EXPECT_NEAR(chip_temperature_K(calibration, 12'000, 3.3f), 273.15f + 30.0f, 1e-2f);
  EXPECT_NEAR(chip_temperature_K(calibration, 14'000, 3.3f), 273.15f + 70.0f, 1e-2f);
  EXPECT_EQ(chip_temperature_K({}, 14'000, 3.3f), 0.0f);
}

}  // namespace
}  // namespace rosflight::boards::parts
