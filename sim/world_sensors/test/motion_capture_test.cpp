// SPDX-License-Identifier: BSD-3-Clause
#include "sim/world_sensors/motion_capture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/world_sensors/test/rig.hpp"

namespace rosflight::sim::testing {
namespace {

constexpr std::int64_t kPeriod_us = 10'000;

std::vector<PoseSample> measured(const MotionCapture::Config& config, int count, const Truth& where,
                                 std::uint64_t seed = 7) {
  Site site;
  site.random = RandomSource{seed};
  MotionCapture cameras(config, site.site);
  std::vector<PoseSample> out;
  Truth truth = where;
  for (int k = 0; k < count; ++k) {
    truth.time = Time{kPeriod_us * k};
    PoseSample sample;
    if (cameras.measure(truth, sample)) out.push_back(sample);
  }
  return out;
}

Vector3 rotation_between(const Quaternion& from, const Quaternion& to) {
  const Eigen::AngleAxisd turn(from.conjugate() * to);
  return turn.angle() * turn.axis();
}

TEST(MotionCapture, WithoutErrorsItIsTheTruth) {
  const Truth where = at({1.0, -2.0, -3.0}, 0.7, Vector3(1.0, 2.0, 2.0) / 3.0);
  const auto samples = measured({}, 3, where);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[2].stamp, Time{2 * kPeriod_us});
  EXPECT_EQ(samples[2].p_W, where.body.p_W);
  EXPECT_NEAR(samples[2].q_WB.angularDistance(where.body.q_WB), 0.0, 1e-15);
}

TEST(MotionCapture, NoiseHasItsSigmaInEachAxisAndNoneIsLikeAnother) {
  constexpr int kCount = 50'000;
  MotionCapture::Config config;
  config.position_m.axis.noise_sigma = 0.002;
  config.attitude_rad.axis.noise_sigma = 0.005;
  const Truth where = at({1.0, -2.0, -3.0}, 0.7, Vector3(1.0, 2.0, 2.0) / 3.0);
  Eigen::Matrix<double, 6, 6> products = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  for (const PoseSample& sample : measured(config, kCount, where)) {
    Eigen::Matrix<double, 6, 1> e;
    e << (sample.p_W - where.body.p_W) / 0.002,
        rotation_between(where.body.q_WB, sample.q_WB) / 0.005;
    products += e * e.transpose();
    sum += e;
  }
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(sum(i) / kCount, 0.0, kSigmas / std::sqrt(kCount)) << i;
    for (int j = 0; j < 6; ++j) {
      const double expected = i == j ? 1.0 : 0.0;
      const double spread = std::sqrt((i == j ? 2.0 : 1.0) / kCount);
      EXPECT_NEAR(products(i, j) / kCount, expected, kSigmas * spread) << i << " " << j;
    }
  }
}

TEST(MotionCapture, AWanderingBiasHasItsAllanDeviation) {
  // Random walk of 1 mm/sqrt(s): Allan deviation K sqrt(tau/3) at tau = 3 s is K (IEEE Std 952-1997, C.1.3).
  constexpr int kCount = 600'000;
  constexpr std::size_t kCluster = 300;
  MotionCapture::Config config;
  config.position_m.axis.bias_walk = 1e-3;
  const auto samples = measured(config, kCount, at(Vector3::Zero()));
  std::vector<double> means;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k % kCluster == 0) means.push_back(0.0);
    means.back() += samples[k].p_W.y() / kCluster;
  }
  double squares = 0.0;
  for (std::size_t k = 1; k < means.size(); ++k)
    squares += (means[k] - means[k - 1]) * (means[k] - means[k - 1]);
  const auto count = static_cast<double>(means.size() - 1);
  const double deviation = std::sqrt(squares / (2.0 * count));
  // Neighbouring differences have the correlation 1/4: sim/test/noise_test.cpp.
  EXPECT_NEAR(deviation / 1e-3, 1.0, kSigmas * std::sqrt((1.0 + 2.0 / 16.0) / (2.0 * count)));
}

TEST(MotionCapture, DropOutsComeAndGoWithTheirMeanTimes) {
  constexpr int kCount = 2'000'000;  // 20 000 s, about 1905 drop-outs
  MotionCapture::Config config;
  config.dropouts = {10.0, 0.5};
  const auto samples = measured(config, kCount, at(Vector3::Zero()));
  int dropouts = 0;
  for (std::size_t k = 1; k < samples.size(); ++k)
    if (samples[k].stamp - samples[k - 1].stamp > Time{kPeriod_us}) ++dropouts;
  // Share of time 0.5/10.5; n cycles of two exponential times spread it by share (1 - share) sqrt(2/n). One
  // drop-out in 50 is shorter than the period and not seen, two in a thousand merge.
  const double share = 0.5 / 10.5;
  const double cycles = 20'000.0 / 10.5;
  EXPECT_NEAR(1.0 - static_cast<double>(samples.size()) / kCount, share,
              kSigmas * share * (1.0 - share) * std::sqrt(2.0 / cycles));
  EXPECT_NEAR(dropouts, 0.98 * cycles, kSigmas * std::sqrt(cycles * (100.0 + 0.25)) / 10.5);
}

TEST(MotionCapture, ADelayMovesTheArrivalAndNotTheStamp) {
  const Vehicle vehicle =
      vehicle_with("{mocap: {type: motion_capture, rate_Hz: 100, delay_us: 50000}}");
  Registry registry;
  register_world_sensors(registry);
  const world::WorldShapes shapes;
  WorldSensors sensors(registry, vehicle, shapes, RandomSource{1}, kStep);
  int count = 0;
  for (std::int64_t k = 0; k < 400; ++k) {
    const Time now = k * kStep;
    sensors.step(at({to_seconds(now), 0.0, 0.0}, 0.0, Vector3::UnitZ(), now),
                 [&](const std::string& name, const WorldSample& sample) {
                   const auto& pose = std::get<PoseSample>(sample);
                   EXPECT_EQ(name, "mocap");
                   EXPECT_EQ(now - pose.stamp, Time{50'000});
                   EXPECT_NEAR(pose.p_W.x(), to_seconds(pose.stamp), 1e-12);
                   ++count;
                 });
  }
  EXPECT_EQ(count, 95);  // of 100 a second, those of the last 50 ms are on their way
}

TEST(MotionCapture, SeesNothingOutsideTheRoom) {
  MotionCapture::Config config;
  config.max_m = 5.0;
  EXPECT_EQ(measured(config, 4, at({3.0, 4.1, 0.0})).size(), 0U);
  EXPECT_EQ(measured(config, 4, at({3.0, 3.9, 0.0})).size(), 4U);
}

}  // namespace
}  // namespace rosflight::sim::testing
