// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gyro_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace rosflight::flight {
namespace {

constexpr double kRate_Hz = 400.0;

/// White noise of 1 rad/s rms on each axis before, after a one-pole low-pass behind it.
Spectrum low_passed(float memory, int samples) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise;
  Spectrum spectrum;
  Spectrum::Rates after{};
  for (int k = 0; k < samples; ++k) {
    Spectrum::Rates before{noise(random), noise(random), noise(random)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      after[axis] = memory * after[axis] + (1.0F - memory) * before[axis];
    }
    spectrum.add(before, after);
  }
  return spectrum;
}

TEST(Spectrum, WhiteNoiseIsFlatAndItsPowerIsItsVariance) {
  const GyroSpectrum s = low_passed(0.0F, 40'000).result(kRate_Hz);
  ASSERT_EQ(s.frequency_Hz.size(), Spectrum::kSegment / 2);
  double power = 0.0;
  for (std::size_t k = 2; k + 1 < s.before.size(); ++k) {
    power += s.before[k] * s.before[k] * kRate_Hz / Spectrum::kSegment;
    // Three axes of variance 1 over 200 Hz; 311 segments give 3 % of scatter.
    EXPECT_NEAR(s.before[k], std::sqrt(3.0 / 200.0), 0.2 * std::sqrt(3.0 / 200.0)) << k;
    EXPECT_EQ(s.before[k], s.after[k]);
  }
  EXPECT_NEAR(power, 3.0, 0.15);
  EXPECT_NEAR(s.latency_s, 0.0, 1e-9);
}

TEST(Spectrum, ASineIsALineAtItsFrequency) {
  Spectrum spectrum;
  for (int k = 0; k < 2000; ++k) {
    const double t = k / kRate_Hz;
    const auto x = static_cast<float>(std::sin(2.0 * std::numbers::pi * 50.0 * t));
    spectrum.add({x, 0.0F, 0.0F}, {0.1F * x, 0.0F, 0.0F});
  }
  const GyroSpectrum s = spectrum.result(kRate_Hz);
  const auto peak = std::max_element(s.before.begin(), s.before.end()) - s.before.begin();
  EXPECT_DOUBLE_EQ(s.frequency_Hz[static_cast<std::size_t>(peak)], 50.0);
  EXPECT_NEAR(s.after[static_cast<std::size_t>(peak)],
              0.1 * s.before[static_cast<std::size_t>(peak)], 1e-6);
}

TEST(Spectrum, TheDelayOfALowPassIsItsGroupDelayAtLowFrequencies) {
  // One pole with memory a delays slow motion by a / (1 - a) samples: 0.3 at 400 Hz 1.071 ms. The
  // delay falls by 2 % up to 15 Hz.
  const GyroSpectrum s = low_passed(0.3F, 20'000).result(kRate_Hz);
  EXPECT_NEAR(s.latency_s, 0.3 / 0.7 / kRate_Hz, 0.04e-3);
}

TEST(Spectrum, SignalsThatHaveNothingInCommonHaveNoDelay) {
  std::mt19937 random(2);
  std::normal_distribution<float> noise;
  Spectrum spectrum;
  for (int k = 0; k < 20'000; ++k) {
    spectrum.add({noise(random), 0.0F, 0.0F}, {noise(random), 0.0F, 0.0F});
  }
  EXPECT_TRUE(std::isnan(spectrum.result(kRate_Hz).latency_s));
}

TEST(Spectrum, NothingComesOfTooFewSamplesGapsAndWhatIsNoNumber) {
  Spectrum spectrum;
  EXPECT_TRUE(spectrum.result(kRate_Hz).frequency_Hz.empty());
  for (std::size_t k = 0; k < Spectrum::kSegment - 1; ++k) spectrum.add({1, 2, 3}, {1, 2, 3});
  spectrum.gap();
  for (std::size_t k = 0; k < Spectrum::kSegment - 1; ++k) spectrum.add({1, 2, 3}, {1, 2, 3});
  spectrum.add({std::nanf(""), 0, 0}, {0, 0, 0});
  spectrum.add({0, 0, 0}, {0, 0, 0});
  EXPECT_EQ(spectrum.segments(), 0U);
  EXPECT_TRUE(spectrum.result(kRate_Hz).frequency_Hz.empty());
  EXPECT_TRUE(low_passed(0.0F, 1000).result(0.0).frequency_Hz.empty());
}

}  // namespace
}  // namespace rosflight::flight
