// SPDX-License-Identifier: BSD-3-Clause
// Does the filter have the errors that it reports? Normalised squared errors of the state (NEES) and of the
// innovations (NIS) over 60 seeded flights whose noise is what the filter assumes. Y. Bar-Shalom,
// X. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001,
// sec. 5.4.2: the sum of the NEES of N runs at one time is chi-square with N n degrees of freedom.
#include <gtest/gtest.h>

#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

constexpr int kRuns = 60;
constexpr double kFlight_s = 40.0;

/// Quantile of chi-square by E. B. Wilson, M. M. Hilferty (1931), good to 1e-4 above 100 degrees of
/// freedom.
double chi_square(double degrees, double normal_quantile) {
  const double c = 2.0 / (9.0 * degrees);
  const double root = 1.0 - c + normal_quantile * std::sqrt(c);
  return degrees * root * root * root;
}
constexpr double k999 = 3.2905;  ///< Two-sided 99.9 %.

struct Statistics {
  static constexpr int kEpochs = static_cast<int>(kFlight_s);
  std::array<double, kEpochs> nees{};
  std::array<double, kAids> nis{};
  std::array<std::uint64_t, kAids> innovations{};
  std::uint64_t rejected{};
};

constexpr int kUsed = ErrorStateEkf::kAirScale;  // the air force and its errors are not used here

double nees(const NominalState& truth, const ErrorStateEkf& filter) {
  const Eigen::Matrix<double, kUsed, 1> e =
      ErrorStateEkf::difference(truth, filter.state()).head<kUsed>();
  return e.dot(filter.covariance().topLeftCorner<kUsed, kUsed>().ldlt().solve(e));
}

template <bool kWind>
void fly(std::uint64_t seed, Statistics& statistics) {
  using Filter = ErrorStateEkf;
  WorldConfig world_config;
  EstimatorConfig& config = world_config.filter;
  config.declination_rad = field_declination();
  // The wind and the air of the filter wander; those of a closed form cannot.
  config.noise.wind_m_s_rts = config.max_wind_noise_m_s_rts = config.noise.air_scale_rts = 0.0;
  config.gnss_position_sigma_m = config.gnss_time_sigma_s = 0.0;  // its antenna is in its place
  config.use_sideslip = false;                                    // measured by a vane, with noise
  config.gate_sigma = config.heading_gate_sigma = 1e3;
  config.baro_relearn_s = config.gnss_reset_s = 1e9;
  world_config.seed = seed;
  world_config.fixedwing = kWind;
  // What a calibration leaves. With 0.1 m/s^2 the filter, which is of first order, is too sure of
  // itself by 16 % of the NEES from the 5th to the 9th second, until tilt and bias are distinguished.
  world_config.gyro_bias_sigma = 0.005;
  world_config.accel_bias_sigma = 0.03;
  const double phase = 0.1 * static_cast<double>(seed % 30);
  Path path = [phase](double t) { return multirotor_at(t, phase); };
  if constexpr (kWind) {
    world_config.wind_W = {4.0 * std::cos(phase), -5.0 * std::sin(phase), 0.0};
    const Vector3 wind_W = world_config.wind_W;
    path = [phase, wind_W](double t) { return fixedwing_at(t, phase, wind_W); };
  }
  World world(world_config, path);

  // The start is off by a draw from the covariance that the filter is given.
  Filter::Covariance P = Filter::Covariance::Zero();
  const auto sigma = [&P](int first, int size, double s) {
    for (int k = first; k < first + size; ++k) P(k, k) = s * s;
  };
  sigma(Filter::kTheta, 2, 0.01);
  sigma(Filter::kTheta + 2, 1, 0.03);
  sigma(Filter::kVelocity, 3, 0.2);
  sigma(Filter::kPosition, 3, 0.5);
  sigma(Filter::kGyroBias, 3, world_config.gyro_bias_sigma);
  sigma(Filter::kAccelBias, 3, world_config.accel_bias_sigma);
  sigma(Filter::kBaroBias, 1, 0.5);
  sigma(Filter::kWind, 2, kWind ? 1.0 : 1e-3);
  sigma(Filter::kGnssBias, 3, 0.05);
  sigma(Filter::kMagBias, 3, world_config.mag_bias_sigma_T / Filter::kMicrotesla);
  Estimator estimator(config, kWind ? Airframe::kFixedWing : Airframe::kMultirotor);

  Filter::Error draw;
  std::mt19937_64 generator(seed + 1000);
  std::normal_distribution<double> normal;
  for (int k = 0; k < Filter::kSize; ++k) draw(k) = std::sqrt(P(k, k)) * normal(generator);
  // truth = start [+] draw: the estimate is taken where this holds
  NominalState guess = Filter::added(world.initial_truth(), -draw);
  estimator.start_at(
      0.0, guess, P, World::origin(),
      World::pressure_at(World::origin().altitude_m - guess.p_W.z() + guess.baro_bias_m));
  std::array<std::uint64_t, kAids> seen{};
  int epoch = 0;
  while (world.time_s() < kFlight_s) {
    world.step(estimator);
    for (std::size_t a = 0; a < kAids; ++a) {
      const AidHealth& aid = estimator.health().aids[a];
      if (aid.accepted + aid.rejected == seen[a]) continue;
      // Only the last of several in a step is seen; they come one at a time.
      seen[a] = aid.accepted + aid.rejected;
      statistics.nis[a] += aid.nis;
      ++statistics.innovations[a];
    }
    const double t = estimator.filter_time_s();
    if (t < epoch + 0.999) continue;
    const NominalState truth = world.truth_at(t);
    statistics.nees[static_cast<std::size_t>(epoch++)] += nees(truth, estimator.filter());
  }
  for (const AidHealth& aid : estimator.health().aids) statistics.rejected += aid.rejected;
  EXPECT_EQ(estimator.health().late, 0U);
}

template <bool kWind>
void check() {
  Statistics statistics;
  for (int run = 1; run <= kRuns; ++run) fly<kWind>(static_cast<std::uint64_t>(run), statistics);
  EXPECT_EQ(statistics.rejected, 0U);
  const double low = chi_square(kRuns * kUsed, -k999);
  const double high = chi_square(kRuns * kUsed, k999);
  double sum = 0.0;
  for (int k = 0; k + 1 < Statistics::kEpochs; ++k) {
    const double nees = statistics.nees[static_cast<std::size_t>(k)];
    sum += nees / (kRuns * kUsed);
    EXPECT_GT(nees, low) << "after " << k + 1 << " s";
    EXPECT_LT(nees, high) << "after " << k + 1 << " s";
  }
  std::printf("NEES by its degrees of freedom, mean of %d epochs: %.3f (one epoch: %.3f to %.3f)\n",
              Statistics::kEpochs - 1, sum / (Statistics::kEpochs - 1), low / (kRuns * kUsed),
              high / (kRuns * kUsed));
  constexpr std::array<const char*, kAids> kNames{
      "gnss horizontal", "gnss altitude", "gnss velocity", "baro", "heading",
      "range",           "pitot",         "sideslip",      "rest"};
  constexpr std::array<int, kAids> kRows{2, 1, 3, 1, 1, 1, 1, 1, 3};
  for (std::size_t a = 0; a < kAids; ++a) {
    if (statistics.innovations[a] == 0) continue;
    const double degrees = static_cast<double>(statistics.innovations[a]) * kRows[a];
    const double nis = statistics.nis[a] * kRows[a];
    std::printf("NIS %-16s %.4f of %.4f to %.4f\n", kNames[a], nis / degrees,
                chi_square(degrees, -k999) / degrees, chi_square(degrees, k999) / degrees);
    EXPECT_GT(nis, chi_square(degrees, -k999)) << kNames[a];
    EXPECT_LT(nis, chi_square(degrees, k999)) << kNames[a];
  }
}

TEST(Consistency, OfTheMultirotorFilter) {
  check<false>();
}

TEST(Consistency, OfTheFixedWingFilter) {
  check<true>();
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
