// SPDX-License-Identifier: BSD-3-Clause
#include "sim/noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rosflight::sim {
namespace {

/// Bounds are this many standard deviations of the estimate; seeds are fixed, so a test that passes
/// once passes always, and a law that is off by more than its statistics fails.
constexpr double kSigmas = 4.0;

RandomStream stream(int i) {
  return RandomSource{2024}.stream("test/" + std::to_string(i));
}

struct AllanPoint {
  double deviation;
  double clusters;
};

/// Allan deviation for clusters of n samples (IEEE Std 952-1997, eq. C.1).
AllanPoint allan(const std::vector<double>& samples, std::size_t n) {
  const std::size_t clusters = samples.size() / n;
  std::vector<double> means;
  for (std::size_t i = 0; i < clusters; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < n; ++k) sum += samples[i * n + k];
    means.push_back(sum / static_cast<double>(n));
  }
  double squares = 0.0;
  for (std::size_t i = 0; i + 1 < clusters; ++i) {
    squares += (means[i + 1] - means[i]) * (means[i + 1] - means[i]);
  }
  const auto count = static_cast<double>(clusters - 1);
  return {std::sqrt(squares / (2.0 * count)), count};
}

/// Relative standard deviation of an Allan deviation from M differences of clusters. Neighbouring
/// differences have correlation rho, so the mean of their squares has variance 2 (1 + 2 rho^2) / M
/// of its square; rho is -1/2 for white noise and 1/4 for a random walk.
double allan_spread(double differences, double rho) {
  return std::sqrt((1.0 + 2.0 * rho * rho) / (2.0 * differences));
}

class AtRate : public testing::TestWithParam<int> {
 protected:
  Time period() const { return Time{1'000'000 / GetParam()}; }
  std::size_t samples_in(double seconds) const {
    return static_cast<std::size_t>(seconds * GetParam());
  }
};
INSTANTIATE_TEST_SUITE_P(Noise, AtRate, testing::Values(50, 400));

TEST_P(AtRate, WhiteNoiseHasItsDensityAtOneSecondAndSlopeMinusOneHalf) {
  constexpr double kDensity = 2.44e-4;  // rad/s/sqrt(Hz), of a BMI088
  WhiteNoise noise = WhiteNoise::from_density(kDensity, period(), stream(GetParam()));
  std::vector<double> samples(samples_in(6000.0));
  for (double& sample : samples) sample = noise.sample();

  const AllanPoint at_1s = allan(samples, samples_in(1.0));
  EXPECT_NEAR(at_1s.deviation / kDensity, 1.0, kSigmas * allan_spread(at_1s.clusters, -0.5));

  const AllanPoint early = allan(samples, samples_in(0.1));
  const AllanPoint late = allan(samples, samples_in(10.0));
  const double slope = std::log(late.deviation / early.deviation) / std::log(100.0);
  const double spread =
      std::hypot(allan_spread(early.clusters, -0.5), allan_spread(late.clusters, -0.5)) /
      std::log(100.0);
  EXPECT_NEAR(slope, -0.5, kSigmas * spread);
}

TEST_P(AtRate, RandomWalkHasItsRateAtThreeSecondsAndSlopeOneHalf) {
  constexpr double kRate = 1e-3;
  RandomWalk walk(kRate, period(), stream(GetParam()));
  std::vector<double> samples(samples_in(20'000.0));
  for (double& sample : samples) sample = walk.sample();

  // K sqrt(tau/3) is the law of the continuous walk; steps of T change it by the order of
  // (T/tau)^2.
  const AllanPoint at_3s = allan(samples, samples_in(3.0));
  EXPECT_NEAR(at_3s.deviation / kRate, 1.0, kSigmas * allan_spread(at_3s.clusters, 0.25));

  const AllanPoint early = allan(samples, samples_in(1.0));
  const AllanPoint late = allan(samples, samples_in(100.0));
  const double slope = std::log(late.deviation / early.deviation) / std::log(100.0);
  const double spread =
      std::hypot(allan_spread(early.clusters, 0.25), allan_spread(late.clusters, 0.25)) /
      std::log(100.0);
  EXPECT_NEAR(slope, 0.5, kSigmas * spread);
}

TEST_P(AtRate, RandomWalkSpreadsWithTimeWhateverTheRate) {
  constexpr int kRuns = 4000;
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    RandomWalk walk(0.1, period(), stream(run));
    double value = 0.0;
    for (std::size_t k = 0; k < samples_in(4.0); ++k) value = walk.sample();
    squares += value * value;
  }
  // rate sqrt(t) = 0.1 * 2; a variance estimated from n runs has relative spread sqrt(2/n).
  EXPECT_NEAR(squares / kRuns / 0.04, 1.0, kSigmas * std::sqrt(2.0 / kRuns));
}

TEST_P(AtRate, GaussMarkovIsStationaryFromTheFirstSampleAndForgetsExponentially) {
  constexpr int kRuns = 20'000;
  constexpr double kSigma = 1.7;
  constexpr double kTau_s = 0.4;
  double first_sq = 0.0;
  double last_sq = 0.0;
  double product = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    GaussMarkov drift(kSigma, kTau_s, period(), stream(run));
    const double first = drift.sample();
    double last = first;
    for (std::size_t k = 0; k < samples_in(kTau_s); ++k) last = drift.sample();
    first_sq += first * first;
    last_sq += last * last;
    product += first * last;
  }
  const double spread = std::sqrt(2.0 / kRuns);
  EXPECT_NEAR(first_sq / kRuns / (kSigma * kSigma), 1.0, kSigmas * spread);
  EXPECT_NEAR(last_sq / kRuns / (kSigma * kSigma), 1.0, kSigmas * spread);
  // Correlation one time constant apart is 1/e; an estimate from n pairs has spread (1 -
  // rho^2)/sqrt(n).
  const double rho = std::exp(-1.0);
  EXPECT_NEAR(product / std::sqrt(first_sq * last_sq), rho,
              kSigmas * (1.0 - rho * rho) / std::sqrt(kRuns));
}

TEST(Noise, WhiteNoisePerSampleHasItsSigma) {
  constexpr int kSamples = 100'000;
  WhiteNoise noise = WhiteNoise::per_sample(0.5, stream(1));
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = noise.sample();
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, kSigmas * 0.5 / std::sqrt(kSamples));
  EXPECT_NEAR(squares / kSamples, 0.25, kSigmas * 0.25 * std::sqrt(2.0 / kSamples));
}

TEST(Noise, TurnOnBiasIsUniform) {
  constexpr int kRuns = 10'000;
  std::vector<double> values(kRuns);
  for (int run = 0; run < kRuns; ++run) {
    values[static_cast<std::size_t>(run)] = turn_on_bias(3.0, stream(run));
  }
  std::sort(values.begin(), values.end());
  // Kolmogorov-Smirnov: sqrt(n) D stays below 1.95 in 99.9 % of all cases.
  double distance = 0.0;
  for (int i = 0; i < kRuns; ++i) {
    const double uniform = (values[static_cast<std::size_t>(i)] + 3.0) / 6.0;
    distance = std::max({distance, std::abs(uniform - static_cast<double>(i) / kRuns),
                         std::abs(uniform - static_cast<double>(i + 1) / kRuns)});
  }
  EXPECT_LT(distance * std::sqrt(kRuns), 1.95);
  EXPECT_GE(values.front(), -3.0);
  EXPECT_LT(values.back(), 3.0);
}

TEST(Noise, QuantiserRoundsToStepsAndLimits) {
  const Quantiser eighths(0.125, 2.0);
  EXPECT_EQ(eighths.apply(0.06), 0.0);
  EXPECT_EQ(eighths.apply(0.07), 0.125);
  EXPECT_EQ(eighths.apply(-0.07), -0.125);
  EXPECT_EQ(eighths.apply(0.0625), 0.0);  // halves go to the even step
  EXPECT_EQ(eighths.apply(0.1875), 0.25);
  EXPECT_EQ(eighths.apply(1.99), 2.0);
  EXPECT_EQ(eighths.apply(700.0), 2.0);
  EXPECT_EQ(eighths.apply(-700.0), -2.0);
  const Quantiser off(0.0, 0.0);
  EXPECT_EQ(off.apply(1234.5678), 1234.5678);
}

TEST(Noise, QuantisationErrorIsThatOfAUniformStep) {
  constexpr int kSamples = 100'000;
  const Quantiser quantiser(0.01, 0.0);
  RandomStream values = stream(0);
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double x = values.uniform(-5.0, 5.0);
    const double error = quantiser.apply(x) - x;
    EXPECT_LE(std::abs(error), 0.005 * (1.0 + 1e-9));
    squares += error * error;
  }
  // Variance step^2/12; that of the square of a uniform error is 4/5 of its square.
  EXPECT_NEAR(squares / kSamples * 12.0 / 1e-4, 1.0, kSigmas * std::sqrt(0.8 / kSamples));
}

TEST(Noise, DelayLineKeepsOrderAndTime) {
  DelayLine<int> line(Time{250}, Time{100});
  std::vector<std::pair<std::int64_t, int>> seen;
  for (std::int64_t t = 0; t <= 1000; t += 50) {
    if (t % 100 == 0) line.push(Time{t}, static_cast<int>(t));
    int value = -1;
    if (line.pop(Time{t}, value)) seen.emplace_back(t, value);
  }
  ASSERT_EQ(seen.size(), 8U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i].second, static_cast<int>(100 * i));
    EXPECT_EQ(seen[i].first, seen[i].second + 250);
  }
}

TEST(ErrorModel, PerfectInstrumentShowsTheTruth) {
  ErrorModel model({}, Time{2500}, RandomSource{1}, "x");
  EXPECT_EQ(model.apply(1.0 / 3.0), 1.0 / 3.0);
  EXPECT_EQ(model.bias(), 0.0);
}

TEST(ErrorModel, AddsFixedAndTurnOnBiasOnceForARun) {
  const ErrorParameters p{.fixed_bias = 10.0, .turn_on_bias = 1.0};
  ErrorModel model(p, Time{2500}, RandomSource{1}, "x");
  const double first = model.apply(0.0);
  EXPECT_NEAR(first, 10.0, 1.0);
  EXPECT_NE(first, 10.0);
  EXPECT_EQ(model.apply(0.0), first);
  EXPECT_EQ(model.bias(), first);
  ErrorModel other(p, Time{2500}, RandomSource{2}, "x");
  EXPECT_NE(other.apply(0.0), first);
}

TEST(ErrorModel, DensityAndSigmaAddInPower) {
  // 400 Hz: 0.003/sqrt(2.5 ms) = 0.06; with 0.08 and an extra 0.24: sqrt(0.0036 + 0.0064 + 0.0576)
  // = 0.26.
  const ErrorParameters p{.noise_density = 0.003, .noise_sigma = 0.08};
  ErrorModel model(p, Time{2500}, RandomSource{1}, "x");
  constexpr int kSamples = 50'000;
  double squares = 0.0;
  for (int i = 0; i < kSamples; ++i) squares += std::pow(model.apply(0.0, 0.24), 2);
  EXPECT_NEAR(std::sqrt(squares / kSamples) / 0.26, 1.0, kSigmas / std::sqrt(2.0 * kSamples));
}

TEST(ErrorModel, SwitchingOneErrorOffLeavesTheOthersAsTheyWere) {
  ErrorParameters p{.noise_sigma = 1.0, .bias_walk = 0.5, .drift_sigma = 2.0, .drift_time_s = 3.0};
  ErrorModel all(p, Time{2500}, RandomSource{1}, "x");
  p.bias_walk = 0.0;
  p.drift_sigma = 0.0;
  ErrorModel white(p, Time{2500}, RandomSource{1}, "x");
  for (int i = 0; i < 100; ++i) {
    const double everything = all.apply(0.0);
    EXPECT_NEAR(everything - all.bias(), white.apply(0.0), 1e-12);
  }
}

TEST(ErrorModel, QuietSamplesHaveBiasButNoWhiteNoise) {
  ErrorModel model({.fixed_bias = 0.25, .noise_sigma = 1.0}, Time{2500}, RandomSource{1}, "x");
  EXPECT_EQ(model.apply_quietly(1.0), 1.25);
  EXPECT_NE(model.apply(1.0), 1.25);
}

}  // namespace
}  // namespace rosflight::sim
