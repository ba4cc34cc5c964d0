// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/gyro_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

namespace rosflight::core {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// Response to a sine once it has settled, by correlation over whole periods: independent of the
/// formulas of the filters.
std::complex<double> response(GyroChain chain, double rate_Hz, double frequency_Hz) {
  const auto settle = static_cast<int>(2 * rate_Hz);
  const auto measured = static_cast<int>(4 * rate_Hz);
  std::complex<double> sum = 0.0;
  for (int k = 0; k < settle + measured; ++k) {
    const double phase = kTwoPi * frequency_Hz / rate_Hz * k;
    const auto x = static_cast<float>(std::cos(phase));
    const Vector3 y = chain.step({x, -x, 0.0f});
    EXPECT_EQ(y.x(), -y.y());
    EXPECT_EQ(y.z(), 0.0f);
    if (k >= settle) sum += 2.0 * double{y.x()} * std::polar(1.0, -phase) / double(measured);
  }
  return sum;
}

double dB(std::complex<double> h) {
  return 20 * std::log10(std::abs(h));
}

class GyroChainAt : public testing::TestWithParam<double> {};

TEST_P(GyroChainAt, LowPassIsThreeDecibelsDownAtItsCutOffWhateverTheRate) {
  const double rate = GetParam();
  for (const double cut_off : {20.0, 80.0, 150.0}) {
    const GyroChain chain(
        {.sample_rate_Hz = static_cast<float>(rate), .low_pass_Hz = static_cast<float>(cut_off)});
    EXPECT_NEAR(dB(response(chain, rate, cut_off)), -3.0103, 0.01) << cut_off;
    // Second-order Butterworth under the bilinear transform: 1/sqrt(1 + (tan/tan)^4).
    for (const double f : {5.0, 40.0, 100.0, 190.0}) {
      const double ratio = std::tan(kTwoPi / 2 * f / rate) / std::tan(kTwoPi / 2 * cut_off / rate);
      EXPECT_NEAR(std::abs(response(chain, rate, f)), 1 / std::sqrt(1 + std::pow(ratio, 4)), 1e-3)
          << cut_off << " at " << f;
    }
  }
}

TEST_P(GyroChainAt, NotchIsZeroAtItsCentreAndAsWideAsAskedFor) {
  const double rate = GetParam();
  for (const auto& [centre, width] : {std::pair{100.0, 30.0}, {60.0, 10.0}, {150.0, 50.0}}) {
    const GyroChain chain({.sample_rate_Hz = static_cast<float>(rate),
                           .notch_Hz = static_cast<float>(centre),
                           .notch_width_Hz = static_cast<float>(width)});
    EXPECT_LT(dB(response(chain, rate, centre)), -60.0);
    EXPECT_NEAR(dB(response(chain, rate, 1.0)), 0.0, 0.05);
    // The two -3 dB points: by bisection on either side.
    const auto edge = [&](double inside, double outside) {
      for (int k = 0; k < 16; ++k) {
        const double middle = 0.5 * (inside + outside);
        (dB(response(chain, rate, middle)) < -3.0103 ? inside : outside) = middle;
      }
      return inside;
    };
    const double low = edge(centre, 1.0);
    const double high = edge(centre, rate / 2 - 1.0);
    EXPECT_NEAR(high - low, width, 0.3) << centre;
  }
}

TEST_P(GyroChainAt, GroupDelayIsThatOfThePhase) {
  const double rate = GetParam();
  const GyroChain chain({.sample_rate_Hz = static_cast<float>(rate),
                         .low_pass_Hz = 80.0f,
                         .notch_Hz = 120.0f,
                         .notch_width_Hz = 30.0f});
  for (const double f : {5.0, 20.0, 60.0, 90.0}) {
    const double step = 0.25;
    const double delay =
        -std::arg(response(chain, rate, f + step) / response(chain, rate, f - step)) /
        (kTwoPi * 2 * step);
    EXPECT_NEAR(chain.group_delay_s(static_cast<float>(f)), delay, 3e-5) << f;
  }
  EXPECT_EQ(chain.group_delay_s(static_cast<float>(rate)), 0.0f);
  EXPECT_EQ(chain.group_delay_s(kNan), 0.0f);
  EXPECT_EQ(GyroChain{}.group_delay_s(10.0f), 0.0f);
}

TEST_P(GyroChainAt, StepResponseIsFiniteAndSettles) {
  GyroChain chain({.sample_rate_Hz = static_cast<float>(GetParam()),
                   .low_pass_Hz = 50.0f,
                   .notch_Hz = 100.0f,
                   .notch_width_Hz = 30.0f});
  chain.step(Vector3::Zero());
  float largest = 0.0f;
  Vector3 y;
  for (int k = 0; k < 2000; ++k) {
    y = chain.step({1.0f, -34.0f, 1e3f});
    largest = std::max(largest, y.x());
  }
  EXPECT_LT(largest, 1.35f);
  EXPECT_NEAR(y.x(), 1.0f, 1e-5f);
  EXPECT_NEAR(y.y(), -34.0f, 5e-4f);
  EXPECT_NEAR(y.z(), 1e3f, 1e-2f);
}

INSTANTIATE_TEST_SUITE_P(Rates, GyroChainAt, testing::Values(400.0, 1000.0, 2000.0));

TEST(GyroChain, OffChangesNothing) {
  GyroChain chain({.sample_rate_Hz = 1000.0f});
  EXPECT_FALSE(chain.on());
  for (int k = 0; k < 10; ++k) {
    const Vector3 x{0.1f * static_cast<float>(k), 1.0f, -3.0f};
    EXPECT_EQ(chain.step(x), x);
  }
}

TEST(GyroChain, FrequenciesAtOrAboveHalfTheRateAreOffAndReported) {
  for (const float bad : {200.0f, 300.0f, 1e9f, -5.0f, kNan}) {
    GyroChain chain;
    const auto refused = chain.configure(
        {.sample_rate_Hz = 400.0f, .low_pass_Hz = bad, .notch_Hz = bad, .notch_width_Hz = 30.0f});
    EXPECT_TRUE(refused.low_pass && refused.notch) << bad;
    EXPECT_FALSE(chain.on());
  }
  GyroChain chain;
  EXPECT_FALSE(chain.configure({.sample_rate_Hz = 400.0f, .low_pass_Hz = 195.0f}).low_pass);
  EXPECT_TRUE(
      chain.configure({.sample_rate_Hz = 400.0f, .notch_Hz = 100.0f, .notch_width_Hz = 200.0f})
          .notch);
  EXPECT_TRUE(chain.configure({.sample_rate_Hz = 0.0f, .low_pass_Hz = 10.0f}).low_pass);
  EXPECT_TRUE(chain.configure({.sample_rate_Hz = kNan, .low_pass_Hz = 10.0f}).low_pass);
}

TEST(GyroChain, StartsSettledAtItsFirstSample) {
  GyroChain chain({.sample_rate_Hz = 1000.0f, .low_pass_Hz = 20.0f, .notch_Hz = 100.0f});
  for (int k = 0; k < 100; ++k) {
    EXPECT_NEAR(chain.step({2.0f, -1.0f, 0.5f}).x(), 2.0f, 1e-4f);
  }
  // Another rate in flight: no jump.
  static_cast<void>(
      chain.configure({.sample_rate_Hz = 2000.0f, .low_pass_Hz = 20.0f, .notch_Hz = 100.0f}));
  for (int k = 0; k < 100; ++k) {
    EXPECT_NEAR(chain.step({2.0f, -1.0f, 0.5f}).y(), -1.0f, 1e-4f);
  }
}

TEST(GyroChain, NotANumberDoesNotStayIn) {
  GyroChain chain({.sample_rate_Hz = 1000.0f, .low_pass_Hz = 50.0f, .notch_Hz = 100.0f});
  GyroChain same = chain;
  for (int k = 0; k < 50; ++k) {
    const Vector3 x{std::sin(0.1f * static_cast<float>(k)), 1.0f, 0.0f};
    if (k % 7 == 0) {
      EXPECT_FALSE(std::isfinite(chain.step({kNan, 0.0f, 0.0f}).x()));
      EXPECT_FALSE(
          std::isfinite(chain.step({0.0f, std::numeric_limits<float>::infinity(), 0.0f}).y()));
    }
    EXPECT_EQ(chain.step(x), same.step(x));
  }
}

TEST(GyroChain, CountsSamplesAtFullScale) {
  constexpr float kFull = 34.906585f;  // 2000 deg/s
  GyroChain chain({.sample_rate_Hz = 1000.0f, .full_scale_rad_s = kFull});
  chain.step({kFull * 0.999f, 0, 0});
  EXPECT_EQ(chain.clipped(), 0u);
  chain.step({kFull * 32767.0f / 32768.0f, 0, 0});
  chain.step({0, -kFull, 0});
  chain.step({0, 0, 2 * kFull});
  chain.step({kNan, kFull, 0});
  EXPECT_EQ(chain.clipped(), 3u);
}

}  // namespace
}  // namespace rosflight::core
