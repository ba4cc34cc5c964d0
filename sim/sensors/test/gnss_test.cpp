// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sensors/gnss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/sensors/test/samples.hpp"

namespace rosflight::sim::sensors {
namespace {

const RandomSource kSource{7};

Gnss::Config perfect() {
  Gnss::Config config;
  config.timing.period = Time{100'000};
  config.satellites = 15;
  config.horizontal_accuracy_m = 1.5;
  config.vertical_accuracy_m = 2.5;
  config.speed_accuracy_m_s = 0.05;
  return config;
}

Gnss receiver(const Gnss::Config& config) {
  const EnvironmentParameters place = test_place();
  return {config, place.origin, place.start_unix_s, kSource};
}

hal::GnssSample measured(Gnss& gnss, const Truth& truth) {
  hal::GnssSample sample;
  EXPECT_TRUE(gnss.measure(truth, sample));
  return sample;
}

TEST(Gnss, AtTheOriginItIsAtTheOrigin) {
  Gnss gnss = receiver(perfect());
  const auto sample = measured(gnss, at_rest());
  EXPECT_EQ(sample.fix, hal::GnssFix::k3d);
  EXPECT_EQ(sample.satellites, 15);
  EXPECT_NEAR(sample.latitude_deg, 40.2463724, 1e-12);
  EXPECT_NEAR(sample.longitude_deg, -111.6474138, 1e-12);
  EXPECT_NEAR(static_cast<double>(sample.height_msl_m), 1387.0, 1e-4);
  EXPECT_FLOAT_EQ(sample.horizontal_accuracy_m, 1.5F);
  EXPECT_FLOAT_EQ(sample.vertical_accuracy_m, 2.5F);
  EXPECT_FLOAT_EQ(sample.speed_accuracy_m_s, 0.05F);
}

TEST(Gnss, APositionNearbyIsWhereTheEllipsoidHasIt) {
  // Radii of curvature at 40.2463724 deg from the WGS-84 formulas a (1 - e2)/W^3 and a/W, W =
  // sqrt(1 - e2 sin^2): meridian 6 362 109.0 m, prime vertical 6 387 073.6 m; plus the height 1387
  // m. 100 m are 1e-5 of that, so what the curvature does to the result stays below 1e-9 deg.
  Gnss gnss = receiver(perfect());
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double s = std::sin(40.2463724 * kDegree);
  const double w = std::sqrt(1.0 - 6.69437999014e-3 * s * s);
  const double meridian_m = 6378137.0 * (1.0 - 6.69437999014e-3) / (w * w * w) + 1387.0;
  const double parallel_m = (6378137.0 / w + 1387.0) * std::cos(40.2463724 * kDegree);
  Truth truth = at_rest();
  truth.body.p_W = {100.0, 0.0, -50.0};
  auto sample = measured(gnss, truth);
  EXPECT_NEAR(sample.latitude_deg - 40.2463724, 100.0 / (meridian_m + 50.0) / kDegree, 2e-9);
  EXPECT_NEAR(static_cast<double>(sample.height_msl_m), 1437.0, 2e-3);
  truth.body.p_W = {0.0, 100.0, 0.0};
  sample = measured(gnss, truth);
  EXPECT_NEAR(sample.longitude_deg + 111.6474138, 100.0 / parallel_m / kDegree, 2e-9);
}

TEST(Gnss, VelocityIsOfTheAntennaOverGround) {
  // Nose east at 10 m/s; antenna 0.5 m behind the centre, yawing at 2 rad/s: it swings 1 m/s to the
  // left, which is north.
  Gnss::Config config = perfect();
  config.position_m = {-0.5, 0.0, 0.0};
  Gnss gnss = receiver(config);
  Truth truth = at_rest();
  truth.body.q_WB = turned(std::numbers::pi / 2.0, Vector3::UnitZ());
  truth.body.v_B = {10.0, 0.0, -1.0};
  truth.body.w_B = {0.0, 0.0, 2.0};
  const auto sample = measured(gnss, truth);
  EXPECT_NEAR(static_cast<double>(sample.velocity_ned_m_s[0]), 1.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(sample.velocity_ned_m_s[1]), 10.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(sample.velocity_ned_m_s[2]), -1.0, 1e-6);
  EXPECT_LT(sample.longitude_deg, -111.6474138);  // behind a nose that points east
}

TEST(Gnss, UnixTimeRunsFromTheStartDate) {
  Gnss gnss = receiver(perfect());
  auto sample = measured(gnss, at_rest());
  EXPECT_EQ(sample.unix_s, 1'780'315'200);
  EXPECT_EQ(sample.unix_ns, 0);
  sample = measured(gnss, at_rest(Time{7'200'000'000 + 123'456}));  // past 2^32 us
  EXPECT_EQ(sample.unix_s, 1'780'315'200 + 7200);
  EXPECT_EQ(sample.unix_ns, 123'456'000);
  EXPECT_EQ(sample.stamp, Time{7'200'123'456});
}

TEST(Gnss, ErrorsHaveTheirSpreadInMetres) {
  Gnss::Config config = perfect();
  config.horizontal_m = {.drift_sigma = 1.7, .drift_time_s = 1100.0};
  config.vertical_m = {.drift_sigma = 2.5, .drift_time_s = 1100.0};
  const EnvironmentParameters place = test_place();
  const LocalFrame frame(place.origin);
  constexpr int kRuns = 4000;  // one sample of each of many receivers: independent
  Vector3 squares = Vector3::Zero();
  for (int run = 0; run < kRuns; ++run) {
    Gnss gnss(config, place.origin, 0, RandomSource{static_cast<std::uint64_t>(run)});
    const auto sample = measured(gnss, at_rest());
    const Vector3 p_W = frame.to_local({.latitude_deg = sample.latitude_deg,
                                        .longitude_deg = sample.longitude_deg,
                                        .altitude_m = static_cast<double>(sample.height_msl_m)});
    squares += p_W.cwiseAbs2();
  }
  const double bound = 4.0 * std::sqrt(2.0 / kRuns);
  EXPECT_NEAR(squares.x() / kRuns / (1.7 * 1.7), 1.0, bound);
  EXPECT_NEAR(squares.y() / kRuns / (1.7 * 1.7), 1.0, bound);
  EXPECT_NEAR(squares.z() / kRuns / (2.5 * 2.5), 1.0, bound);
}

TEST(Gnss, BeforeItsFirstFixItSaysSo) {
  Gnss::Config config = perfect();
  config.first_fix_s = 30.0;
  Gnss gnss = receiver(config);
  const auto before = measured(gnss, at_rest(Time{29'900'000}));
  EXPECT_EQ(before.fix, hal::GnssFix::kNone);
  EXPECT_EQ(before.satellites, 0);
  EXPECT_EQ(before.latitude_deg, 0.0);
  EXPECT_EQ(before.horizontal_accuracy_m, Gnss::kNoAccuracy);
  EXPECT_EQ(measured(gnss, at_rest(Time{30'000'000})).fix, hal::GnssFix::k3d);
}

TEST(Gnss, DropoutsComeAndGoWithTheirMeanTimes) {
  Gnss::Config config = perfect();
  config.dropout_interval_s = 20.0;
  config.dropout_duration_s = 5.0;
  Gnss gnss = receiver(config);
  constexpr int kSamples = 400'000;  // 40 000 s, about 1600 drop-outs
  int without_fix = 0;
  int dropouts = 0;
  bool fix = true;
  for (int i = 0; i < kSamples; ++i) {
    const bool now = measured(gnss, at_rest(Time{100'000LL * i})).fix == hal::GnssFix::k3d;
    if (!now) ++without_fix;
    if (fix && !now) ++dropouts;
    fix = now;
  }
  // Share of time without fix 5/25; with n cycles of two exponential times its spread is
  // 0.2 * 0.8 * sqrt(2/n). Number of drop-outs: 1600, spread sqrt(n (20^2 + 5^2)) / 25 = 33. One in
  // 50 is shorter than the 0.1 s between samples and not seen at all.
  EXPECT_NEAR(static_cast<double>(without_fix) / kSamples, 0.2,
              4.0 * 0.16 * std::sqrt(2.0 / 1600.0));
  EXPECT_NEAR(dropouts, 1600.0 * 0.98, 4.0 * 33.0);
}

TEST(Gnss, ADropoutHoldsTheLastPosition) {
  Gnss::Config config = perfect();
  config.dropout_interval_s = 1.0;
  config.dropout_duration_s = 1.0;
  Gnss gnss = receiver(config);
  Truth truth = at_rest();
  double last_latitude = 0.0;
  bool seen = false;
  for (int i = 0; i < 200; ++i) {
    truth.time = Time{100'000LL * i};
    truth.body.p_W.x() += 1.0;
    const auto sample = measured(gnss, truth);
    if (sample.fix == hal::GnssFix::kNone) {
      EXPECT_EQ(sample.latitude_deg, last_latitude);
      EXPECT_EQ(sample.velocity_ned_m_s, (hal::Vec3{0.0F, 0.0F, 0.0F}));
      seen = true;
    } else {
      EXPECT_GT(sample.latitude_deg, last_latitude);
    }
    last_latitude = sample.latitude_deg;
  }
  EXPECT_TRUE(seen);
}

}  // namespace
}  // namespace rosflight::sim::sensors
