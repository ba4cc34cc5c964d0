// SPDX-License-Identifier: BSD-3-Clause
#include "sim/environment/wind.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace rosflight::sim {
namespace {

/// Statistic of one component of a long record: variance and autocorrelation at a lag.
struct Statistic {
  double variance;
  double correlation;
};

Statistic statistic(const std::vector<double>& x, std::size_t lag) {
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i + lag < x.size(); ++i) {
    square += x[i] * x[i];
    product += x[i] * x[i + lag];
  }
  const auto n = static_cast<double>(x.size() - lag);
  return {square / n, product / square};
}

class DrydenAtStep : public testing::TestWithParam<double> {};

TEST_P(DrydenAtStep, HasVarianceAndCorrelationOfItsSpectrum) {
  // 200 ft: L_u = 200 ft/(0.3416)^1.2 = 725.8 ft = 221.2 m, sigma_u = 0.1 W20/0.3416^0.4.
  const double dt = GetParam();
  constexpr double kHeight_m = 60.96;
  constexpr double kSpeed_m_s = 20.0;
  constexpr double kW20_m_s = 10.0;
  const double length_u = 60.96 / std::pow(0.3416, 1.2);
  const double sigma_u = 1.0 / std::pow(0.3416, 0.4);
  DrydenTurbulence turbulence(kW20_m_s, RandomSource{5});
  constexpr std::size_t kSteps = 2'000'000;
  std::vector<double> u(kSteps);
  std::vector<double> v(kSteps);
  std::vector<double> w(kSteps);
  for (std::size_t i = 0; i < kSteps; ++i) {
    const Vector3 gust = turbulence.step(dt, kHeight_m, kSpeed_m_s);
    u[i] = gust.x();
    v[i] = gust.y();
    w[i] = gust.z();
  }
  const double rate_u = kSpeed_m_s / length_u;
  const double rate_w = kSpeed_m_s / kHeight_m;
  const double record_s = kSteps * dt;
  // Standard error of a variance estimate is about sigma^2 sqrt(2 T_c / T), T_c <= 1/a; four of
  // them.
  const double tolerance_u = 4.0 * std::sqrt(2.0 / (rate_u * record_s));
  const double tolerance_w = 4.0 * std::sqrt(2.0 / (rate_w * record_s));
  const auto lag_u = static_cast<std::size_t>(std::max(1.0, std::round(0.7 / (rate_u * dt))));
  const auto lag_w = static_cast<std::size_t>(std::max(1.0, std::round(0.7 / (rate_w * dt))));
  const double r_u = rate_u * dt * static_cast<double>(lag_u);
  const double r_w = rate_w * dt * static_cast<double>(lag_w);

  const Statistic of_u = statistic(u, lag_u);
  const Statistic of_v = statistic(v, lag_u);
  const Statistic of_w = statistic(w, lag_w);
  EXPECT_NEAR(of_u.variance / (sigma_u * sigma_u), 1.0, tolerance_u);
  EXPECT_NEAR(of_v.variance / (sigma_u * sigma_u), 1.0, tolerance_u);
  EXPECT_NEAR(of_w.variance, 1.0, tolerance_w);
  EXPECT_NEAR(of_u.correlation, std::exp(-r_u), tolerance_u);
  EXPECT_NEAR(of_v.correlation, std::exp(-r_u) * (1.0 - 0.5 * r_u), tolerance_u);
  EXPECT_NEAR(of_w.correlation, std::exp(-r_w) * (1.0 - 0.5 * r_w), tolerance_w);
}

INSTANTIATE_TEST_SUITE_P(Steps, DrydenAtStep, testing::Values(0.01, 0.1, 2.0));

TEST(Dryden, FineStepsFollowTheSameStatisticAsOneCoarseStep) {
  // Structure function over 0.5 s, E[(v(t + 0.5) - v(t))^2] = 2 sigma^2 (1 - rho), from steps
  // of 2.5 ms.
  DrydenTurbulence turbulence(10.0, RandomSource{9});
  constexpr int kBlocks = 40'000;
  const double r = 20.0 * 0.5 / 60.96;
  const double rho = std::exp(-r) * (1.0 - 0.5 * r);
  double sum = 0.0;
  double previous = turbulence.step(0.0025, 60.96, 20.0).z();
  for (int i = 0; i < kBlocks; ++i) {
    double now = 0.0;
    for (int k = 0; k < 200; ++k) now = turbulence.step(0.0025, 60.96, 20.0).z();
    sum += (now - previous) * (now - previous);
    previous = now;
  }
  // Differences over 0.5 s are nearly independent: standard error sqrt(2/n) of the mean square;
  // five of them.
  EXPECT_NEAR(sum / kBlocks / (2.0 * (1.0 - rho)), 1.0, 5.0 * std::sqrt(2.0 / kBlocks));
}

TEST(Wind, SameSeedSameWindOtherSeedOtherWind) {
  WindParameters p;
  p.steady_W_m_s = {3.0, 1.0, 0.0};
  p.random_std_W_m_s = {1.0, 1.0, 0.0};
  p.turbulence_w20_m_s = 8.0;
  p.gusts.mean_interval_s = 2.0;
  Wind a(p, RandomSource{1});
  Wind b(p, RandomSource{1});
  Wind c(p, RandomSource{2});
  for (int i = 0; i < 10'000; ++i) {
    const Vector3 of_a = a.step(0.0025, 20.0, 5.0);
    EXPECT_EQ(of_a, b.step(0.0025, 20.0, 5.0));
    EXPECT_NE(of_a, c.step(0.0025, 20.0, 5.0));
  }
}

TEST(Wind, CalmAndSteadyWindNeverChange) {
  Wind calm({}, RandomSource{1});
  EXPECT_EQ(calm.step(0.01, 10.0, 0.0), Vector3::Zero());
  WindParameters p;
  p.steady_W_m_s = {3.0, -1.0, 0.5};
  Wind steady(p, RandomSource{1});
  EXPECT_EQ(steady.step(0.01, 10.0, 0.0), Vector3(3.0, -1.0, 0.5));
}

TEST(Wind, GustIsOneMinusCosineInDirectionOfTheWind) {
  WindParameters p;
  p.steady_W_m_s = {5.0, 0.0, 0.0};
  p.gusts = {.mean_interval_s = 400.0,
             .magnitude_mean_m_s = 4.0,
             .magnitude_std_m_s = 0.0,
             .direction_std = 0.0,
             .min_s = 2.0,
             .max_s = 2.0};
  Wind wind(p, RandomSource{3});
  constexpr double kStep_s = 0.001;
  double impulse = 0.0;
  double peak = 0.0;
  int rising = 0;
  while (impulse == 0.0 || wind.velocity_W().x() > 5.0) {
    const double gust = wind.step(kStep_s, 10.0, 0.0).x() - 5.0;
    ASSERT_GE(gust, 0.0);
    impulse += gust * kStep_s;
    if (gust > peak) ++rising;
    peak = std::max(peak, gust);
  }
  EXPECT_NEAR(peak, 4.0, 1e-5);              // A
  EXPECT_NEAR(impulse, 4.0, 1e-3);           // A T/2
  EXPECT_NEAR(rising * kStep_s, 1.0, 2e-3);  // half of T
}

TEST(Wind, GustsArriveAtTheirRateWhateverTheStep) {
  WindParameters p;
  p.steady_W_m_s = {5.0, 0.0, 0.0};
  p.gusts = {.mean_interval_s = 3.0,
             .magnitude_mean_m_s = 0.15,
             .magnitude_std_m_s = 0.3,
             .direction_std = 0.0,
             .min_s = 0.5,
             .max_s = 5.0};
  for (const double dt : {0.0025, 0.05}) {
    Wind wind(p, RandomSource{8});
    const double total_s = 30'000.0;
    double sum = 0.0;
    for (std::int64_t i = 0; i < std::llround(total_s / dt); ++i) {
      const double gust = wind.step(dt, 10.0, 0.0).x() - 5.0;
      ASSERT_GE(gust, -1e-12);  // never negative
      sum += gust * dt;
    }
    // Mean of the sum = E[A] E[T] / 2 / interval; normal law cut at 0: E[A] = m + s
    // phi(m/s)/Phi(m/s) = 0.30275.
    const double expected = 0.302748 * 2.75 / 2.0 / 3.0;
    EXPECT_NEAR(sum / total_s, expected,
                0.05 * expected);  // 10 000 gusts, spread of A T about 1.1 of its mean
  }
}

}  // namespace
}  // namespace rosflight::sim
