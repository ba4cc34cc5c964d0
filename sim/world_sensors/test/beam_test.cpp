// SPDX-License-Identifier: BSD-3-Clause
// Lidar and depth camera: their rays against closed forms, their noise against its law.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/world_sensors/depth_camera.hpp"
#include "sim/world_sensors/lidar.hpp"
#include "sim/world_sensors/test/rig.hpp"

namespace rosflight::sim::testing {
namespace {

constexpr double kPi = std::numbers::pi;

world::Shape room(double size_m) {
  return {"room", Vector3::Zero(), Matrix3::Identity(), world::Box{Vector3::Constant(size_m)}};
}

Lidar::Config scanner(int rays, double min_rad, double max_rad) {
  Lidar::Config config;
  config.rays = rays;
  config.angle_min_rad = min_rad;
  config.angle_max_rad = max_rad;
  config.beam.max_m = 100.0;
  return config;
}

ScanSample scan(const Site& site, const Lidar::Config& config, const Truth& truth) {
  ScanSample sample;
  EXPECT_TRUE(Lidar(config, site.site).measure(truth, sample));
  return sample;
}

// ---- lidar

TEST(Lidar, InTheMiddleOfASquareRoomRangesAreOneOverTheLargerOfCosineAndSine) {
  Site site;
  site.shapes.add(room(10.0));
  const ScanSample sample = scan(site, scanner(721, -kPi, kPi), at(Vector3::Zero()));
  ASSERT_EQ(sample.ranges_m.size(), 721U);
  EXPECT_NEAR(sample.angle_step_rad, kPi / 360.0, 1e-15);
  for (std::size_t i = 0; i < 721; ++i) {
    const double a = sample.angle_min_rad + static_cast<double>(i) * sample.angle_step_rad;
    const double expected = 5.0 / std::max(std::abs(std::cos(a)), std::abs(std::sin(a)));
    EXPECT_NEAR(static_cast<double>(sample.ranges_m[i]), expected, 1e-6) << a;  // float
  }
}

TEST(Lidar, AnglesArePositiveToTheLeft) {
  Site site;
  site.shapes.add({"left", {0.0, -4.0, 0.0}, Matrix3::Identity(), world::Sphere{1.0}});
  const ScanSample sample = scan(site, scanner(3, -kPi / 2.0, kPi / 2.0), at(Vector3::Zero()));
  EXPECT_TRUE(std::isinf(sample.ranges_m[0]));
  EXPECT_TRUE(std::isinf(sample.ranges_m[1]));
  EXPECT_NEAR(static_cast<double>(sample.ranges_m[2]), 3.0, 1e-6);
}

TEST(Lidar, TurnsWithTheBodyAndItsMounting) {
  Site site;
  site.shapes.add(
      {"east wall", {0.0, 8.0, 0.0}, Matrix3::Identity(), world::Box{{100.0, 2.0, 100.0}}});
  Lidar::Config config = scanner(1, 0.0, 1.0);
  config.mounting.position_m = {0.5, 0.0, 0.0};
  // Nose east: the wall is 7 m from the centre and 6.5 m from the sensor.
  EXPECT_NEAR(static_cast<double>(scan(site, config, at(Vector3::Zero(), kPi / 2.0)).ranges_m[0]),
              6.5, 1e-6);
  // Nose north, sensor turned to the right: 7 m. At 60 degrees to the right 7/sin 60.
  config.mounting.rotation_deg = {0.0, 0.0, 90.0};
  EXPECT_NEAR(static_cast<double>(scan(site, config, at(Vector3::Zero())).ranges_m[0]), 7.0, 1e-6);
  config.mounting.rotation_deg = {0.0, 0.0, 60.0};
  EXPECT_NEAR(static_cast<double>(scan(site, config, at(Vector3::Zero())).ranges_m[0]),
              7.0 / std::sin(kPi / 3.0), 1e-6);
}

TEST(Lidar, LooksDownWhenTheNoseIsDown) {
  Site site;
  site.shapes.add_level_ground();
  // 2 m above ground, 30 degrees nose down: 2/sin 30.
  const Truth truth = at({0.0, 0.0, -2.0}, -kPi / 6.0, Vector3::UnitY());
  EXPECT_NEAR(static_cast<double>(scan(site, scanner(1, 0.0, 1.0), truth).ranges_m[0]), 4.0, 1e-6);
}

TEST(Lidar, SaysTooNearTooFarAndNothingAsRep117Does) {
  Site site;
  site.shapes.add({"wall", {5.0, 0.0, 0.0}, Matrix3::Identity(), world::Box{{2.0, 2.0, 2.0}}});
  Lidar::Config config = scanner(1, 0.0, 1.0);
  config.beam.min_m = 1.0;
  config.beam.max_m = 3.0;
  const auto range = [&](double x_m) {
    return scan(site, config, at({x_m, 0.0, 0.0})).ranges_m[0];
  };
  EXPECT_EQ(range(0.9), std::numeric_limits<float>::infinity());
  EXPECT_NEAR(static_cast<double>(range(1.1)), 2.9, 1e-6);
  EXPECT_NEAR(static_cast<double>(range(2.9)), 1.1, 1e-6);
  EXPECT_EQ(range(3.1), -std::numeric_limits<float>::infinity());
  config.beam.dropout_share = 1.0;
  EXPECT_TRUE(std::isnan(range(2.0)));
}

// ---- depth camera

TEST(DepthCamera, AWallAcrossItsAxisHasOneDepthInAllPixels) {
  Site site;
  site.shapes.add({"wall", {6.0, 0.0, 0.0}, Matrix3::Identity(), world::Box{{2.0, 100.0, 100.0}}});
  DepthCamera camera({}, site.site);
  DepthSample sample;
  ASSERT_TRUE(camera.measure(at(Vector3::Zero()), sample));
  ASSERT_EQ(sample.depths_m.size(), 64U * 48U);
  for (const float depth : sample.depths_m) ASSERT_NEAR(static_cast<double>(depth), 5.0, 1e-5);
}

TEST(DepthCamera, OverLevelGroundTheDepthOfARowIsThatOfSimilarTriangles) {
  // Looking level 3 m above ground, row v sees it where depth (v - c_v)/f = 3; above the horizon nothing.
  Site site;
  site.shapes.add_level_ground();
  DepthCamera::Config config;
  config.fov_rad = kPi / 2.0;
  config.beam.max_m = 1000.0;
  DepthCamera camera(config, site.site);
  EXPECT_NEAR(camera.focal_px(), 32.0, 1e-12);  // half of 64 px over tan 45
  DepthSample sample;
  ASSERT_TRUE(camera.measure(at({0.0, 0.0, -3.0}), sample));
  for (int v = 0; v < 48; ++v) {
    for (const int u : {0, 31, 63}) {
      const auto depth = static_cast<double>(sample.depths_m[static_cast<std::size_t>(v * 64 + u)]);
      const double below = v - 23.5;
      if (below < 0.0) {
        EXPECT_TRUE(std::isinf(depth)) << v;
      } else {
        EXPECT_NEAR(depth, 3.0 * 32.0 / below, 1e-4) << v;
      }
    }
  }
}

TEST(DepthCamera, ABallIsLargerInTheImageTheNearerItIs) {
  // A ball of 1 m at 5 m: its rim is seen at asin(1/5), at f tan(asin 0.2) = 32 * 0.2041 = 6.53 px.
  Site site;
  site.shapes.add({"ball", {5.0, 0.0, 0.0}, Matrix3::Identity(), world::Sphere{1.0}});
  DepthCamera::Config config;
  config.fov_rad = kPi / 2.0;
  DepthCamera camera(config, site.site);
  DepthSample sample;
  ASSERT_TRUE(camera.measure(at(Vector3::Zero()), sample));
  int seen = 0;
  int expected = 0;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      if (std::isfinite(sample.depths_m[static_cast<std::size_t>(v * 64 + u)])) ++seen;
      if (std::hypot(u - 31.5, v - 23.5) < 32.0 * std::tan(std::asin(0.2))) ++expected;
    }
  }
  EXPECT_EQ(seen, expected);
}

// ---- noise

/// Errors of many readings of a wall at a distance.
std::vector<double> errors(BeamErrorParameters p, double distance_m, int count,
                           std::uint64_t seed = 7) {
  p.max_m = 1000.0;
  BeamErrors beam(p, RandomSource{seed}, "test");
  std::vector<double> out;
  for (int k = 0; k < count; ++k)
    out.push_back(static_cast<double>(beam.apply(distance_m)) - distance_m);
  return out;
}

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}
double mean_square(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value * value;
  return sum / static_cast<double>(x.size());
}

TEST(BeamErrors, WhiteNoiseHasItsSigmaAtEveryDistance) {
  constexpr int kCount = 200'000;
  BeamErrorParameters p;
  p.noise_sigma_m = 0.02;
  p.noise_share = 0.01;
  for (const double distance_m : {1.0, 4.0, 16.0}) {
    const auto e = errors(p, distance_m, kCount);
    const double variance = 0.02 * 0.02 + 1e-4 * distance_m * distance_m;
    // A mean of n draws has the variance 1/n of theirs, a variance the relative one 2/n.
    EXPECT_NEAR(mean(e), 0.0, kSigmas * std::sqrt(variance / kCount)) << distance_m;
    EXPECT_NEAR(mean_square(e) / variance, 1.0, kSigmas * std::sqrt(2.0 / kCount)) << distance_m;
  }
}

TEST(BeamErrors, NeighbouringBeamsAreIndependent) {
  constexpr int kCount = 200'000;
  BeamErrorParameters p;
  p.noise_sigma_m = 0.02;
  const auto e = errors(p, 5.0, kCount);
  for (const std::size_t lag : {1U, 2U, 360U}) {  // beside, beyond, the same ray of the next scan
    double sum = 0.0;
    for (std::size_t k = 0; k + lag < e.size(); ++k) sum += e[k] * e[k + lag];
    EXPECT_NEAR(sum / kCount / (0.02 * 0.02), 0.0, kSigmas / std::sqrt(kCount)) << lag;
  }
}

TEST(BeamErrors, NoiseIsNormalByChiSquareOfTenBins) {
  // Ten bins of equal probability, by the quantiles of the normal law (Abramowitz and Stegun, table 26.1).
  constexpr int kCount = 100'000;
  BeamErrorParameters p;
  p.noise_sigma_m = 0.05;
  const std::array<double, 9> kQuantiles{-1.2815516, -0.8416212, -0.5244005, -0.2533471, 0.0,
                                         0.2533471,  0.5244005,  0.8416212,  1.2815516};
  std::array<int, 10> counts{};
  for (const double error : errors(p, 5.0, kCount)) {
    const auto bin = std::upper_bound(kQuantiles.begin(), kQuantiles.end(), error / 0.05);
    ++counts.at(static_cast<std::size_t>(bin - kQuantiles.begin()));
  }
  double chi_square = 0.0;
  for (const int count : counts) {
    const double expected = kCount / 10.0;
    chi_square += (count - expected) * (count - expected) / expected;
  }
  // Nine degrees of freedom: mean 9, standard deviation sqrt(18). Too small would be as wrong as too large.
  EXPECT_LT(chi_square, 9.0 + kSigmas * std::sqrt(18.0));
  EXPECT_GT(chi_square, 1.15);  // one in a thousand is below
}

TEST(BeamErrors, TurnOnBiasIsUniformOverRunsAndOneOverBeams) {
  constexpr int kRuns = 4000;
  BeamErrorParameters p;
  p.turn_on_bias_m = 0.3;
  double squares = 0.0;
  double largest = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const auto e = errors(p, 8.0, 2, static_cast<std::uint64_t>(run));
    ASSERT_EQ(e[0], e[1]);
    squares += e[0] * e[0];
    largest = std::max(largest, std::abs(e[0]));
  }
  // Variance a^2/3; that of its estimate relative sqrt(4/5/n).
  EXPECT_NEAR(squares / kRuns / 0.03, 1.0, kSigmas * std::sqrt(0.8 / kRuns));
  EXPECT_LE(largest, 0.3 + 1e-6);
}

TEST(BeamErrors, RoundingHasTheVarianceOfAUniformStep) {
  constexpr int kCount = 100'000;
  BeamErrorParameters p;
  p.resolution_m = 0.04;
  p.max_m = 1000.0;
  BeamErrors beam(p, RandomSource{7}, "test");
  RandomStream stream = RandomSource{8}.stream("distances");
  double squares = 0.0;
  for (int k = 0; k < kCount; ++k) {
    const double distance_m = stream.uniform(1.0, 20.0);
    const double y = static_cast<double>(beam.apply(distance_m));
    ASSERT_NEAR(std::remainder(y, 0.04), 0.0, 1e-5);
    squares += (y - distance_m) * (y - distance_m);
  }
  EXPECT_NEAR(squares / kCount / (0.04 * 0.04 / 12.0), 1.0, kSigmas * std::sqrt(0.8 / kCount));
}

TEST(BeamErrors, DropOutsHaveTheirShareAndDisturbNoOtherReading) {
  constexpr int kCount = 100'000;
  BeamErrorParameters p;
  p.noise_sigma_m = 0.02;
  const auto whole = errors(p, 5.0, kCount);
  p.dropout_share = 0.1;
  const auto with_holes = errors(p, 5.0, kCount);
  const auto lost =
      std::count_if(with_holes.begin(), with_holes.end(), [](double e) { return std::isnan(e); });
  EXPECT_NEAR(static_cast<double>(lost) / kCount, 0.1, kSigmas * std::sqrt(0.09 / kCount));
  // The noise has a stream of its own: the readings that are left are the first of those without drop-outs.
  std::vector<double> left;
  std::copy_if(with_holes.begin(), with_holes.end(), std::back_inserter(left),
               [](double e) { return !std::isnan(e); });
  EXPECT_TRUE(std::equal(left.begin(), left.end(), whole.begin()));
}

TEST(BeamErrors, DropOutsFollowNoRhythm) {
  // Runs of readings between drop-outs are geometric: their mean is 1/p, their variance (1 - p)/p^2.
  constexpr int kCount = 200'000;
  BeamErrorParameters p;
  p.dropout_share = 0.2;
  const auto e = errors(p, 5.0, kCount);
  std::vector<double> runs;
  int since = 0;
  for (const double error : e) {
    ++since;
    if (!std::isnan(error)) continue;
    runs.push_back(since);
    since = 0;
  }
  const auto n = static_cast<double>(runs.size());
  EXPECT_NEAR(mean(runs), 5.0, kSigmas * std::sqrt(20.0 / n));
  const double variance = mean_square(runs) - mean(runs) * mean(runs);
  // Kurtosis of a geometric law 9 + p^2/(1 - p): the estimate of its variance spreads by sqrt((8 + p^2/(1-p))/n).
  EXPECT_NEAR(variance / 20.0, 1.0, kSigmas * std::sqrt(8.05 / n));
}

}  // namespace
}  // namespace rosflight::sim::testing
