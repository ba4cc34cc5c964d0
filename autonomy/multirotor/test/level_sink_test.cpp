// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/level_sink.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kGravity_m_s2 = 9.81;
constexpr double kMass_kg = 3.5;
constexpr double weight_N() {
  return kMass_kg * kGravity_m_s2;
}

/// A point mass above flat ground with motors of 50 ms and a drag of 0.2 1/s.
struct Descent {
  Descent(double height_m, double down_m_s) : up_m{height_m}, up_m_s{-down_m_s} { restart(); }

  void restart() {
    sink.start({}, {.height_m = up_m,
                    .down_speed_m_s = -up_m_s,
                    .hover_thrust_N = hover_share * weight_N(),
                    .gravity_m_s2 = kGravity_m_s2,
                    .standing_range_m = 0.0});
  }

  void run(double seconds) {
    constexpr double kStep_s = 0.01;
    for (double end_s = t_s + seconds; t_s < end_s && !touched; t_s += kStep_s) {
      RawMotion raw;
      if (with_baro) raw.baro_up_m = 500.0 + up_m + 0.1 * noise(random);
      if (with_accel) raw.a_B = Vector3(0.0, 0.0, -(force_m_s2 + bias_m_s2 + 0.2 * noise(random)));
      const std::optional<double> range_m =
          with_range && up_m < 8.0 ? std::optional(up_m) : std::nullopt;
      const LevelSink::Output out = sink.step(raw, range_m, kStep_s);
      touched = out.touched;
      wanted_N = out.thrust_N;
      for (int k = 0; k < 10; ++k) move(0.1 * kStep_s);
      fastest_m_s = std::max(fastest_m_s, -up_m_s);
    }
  }

  LevelSink sink;
  double up_m;
  double up_m_s;
  double hover_share{1.0};
  double force_m_s2{kGravity_m_s2};
  double bias_m_s2{0.0};
  double wanted_N{weight_N()};
  double thrust_N{weight_N()};
  double t_s{};
  double fastest_m_s{};
  double impact_m_s{};
  bool with_baro{true};
  bool with_accel{true};
  bool with_range{false};
  bool touched{false};

 private:
  void move(double dt_s) {
    thrust_N += (wanted_N - thrust_N) * dt_s / 0.05;
    force_m_s2 = thrust_N / kMass_kg - 0.2 * up_m_s;
    up_m_s += (force_m_s2 - kGravity_m_s2) * dt_s;
    up_m += up_m_s * dt_s;
    if (up_m > 0.0) return;
    impact_m_s = std::max(impact_m_s, -up_m_s);
    up_m = 0.0;
    up_m_s = std::max(up_m_s, 0.0);
    if (force_m_s2 < kGravity_m_s2) force_m_s2 = kGravity_m_s2;
  }

  std::mt19937 random{1};
  std::normal_distribution<double> noise;
};

TEST(LevelSink, ComesDownByBarometerAndAccelerometer) {
  for (const double down_m_s : {-2.0, 0.0, 2.0}) {
    Descent d(12.0, down_m_s);
    d.bias_m_s2 = 0.1;
    d.run(2.0);
    d.fastest_m_s = 0.0;
    d.run(58.0);
    EXPECT_TRUE(d.touched) << down_m_s;
    EXPECT_EQ(d.up_m, 0.0) << down_m_s;
    EXPECT_LT(d.fastest_m_s, 1.4) << down_m_s;
    EXPECT_LT(d.impact_m_s, 0.6) << down_m_s;
  }
}

TEST(LevelSink, ComesDownByTheBarometerAlone) {
  Descent d(12.0, 0.0);
  d.with_accel = false;
  d.run(60.0);
  EXPECT_TRUE(d.touched);
  EXPECT_EQ(d.up_m, 0.0);
  EXPECT_LT(d.fastest_m_s, 1.6);
  EXPECT_LT(d.impact_m_s, 0.8);
}

TEST(LevelSink, ComesDownByTheAccelerometerAloneWhateverItsBiasIs) {
  for (const double bias_m_s2 : {-0.03, 0.0, 0.03}) {
    Descent d(12.0, 1.0);
    d.with_baro = false;
    d.bias_m_s2 = bias_m_s2;
    d.run(150.0);
    EXPECT_TRUE(d.touched) << bias_m_s2;
    EXPECT_EQ(d.up_m, 0.0) << bias_m_s2;
    EXPECT_LT(d.impact_m_s, 1.6) << bias_m_s2;
  }
}

/// Without either the thrust is the documented one, until the range sensor shows the ground.
TEST(LevelSink, WithoutEitherItsThrustIsTheDocumentedShare) {
  Descent d(6.0, 0.0);
  d.with_baro = d.with_accel = false;
  d.with_range = true;
  d.run(1.0);
  EXPECT_DOUBLE_EQ(d.wanted_N, LevelSink::kShare * weight_N());
  d.run(14.0);
  EXPECT_TRUE(d.touched);
  EXPECT_EQ(d.up_m, 0.0);
  EXPECT_LT(d.impact_m_s, 1.8);
}

TEST(LevelSink, WithoutAnythingItEndsAfterTheTimeThatTheDescentTakes) {
  Descent d(6.0, 0.0);
  d.with_baro = d.with_accel = false;
  d.run(LevelSink::kSpare_s + 6.0 / LevelSink::kSlowest_m_s - 0.5);
  EXPECT_FALSE(d.touched);
  EXPECT_EQ(d.up_m, 0.0);
  d.run((LevelSink::kShare - LevelSink::kNone) / LevelSink::kFall_1_s + 4.0);
  EXPECT_TRUE(d.touched);
  EXPECT_EQ(d.wanted_N, 0.0);
}

/// Its thrust of before was that of a climb: motors that stop in the air are worse than a long wait.
TEST(LevelSink, AVehicleThatHasKeptItsHeightComesDownInTheEnd) {
  Descent d(15.0, 0.0);
  d.hover_share = 1.03;
  d.with_baro = d.with_accel = false;
  d.restart();
  d.run(200.0);
  EXPECT_TRUE(d.touched);
  EXPECT_EQ(d.up_m, 0.0);
  EXPECT_LT(d.impact_m_s, 4.5);
}

/// A pilot flew meanwhile: neither the height nor the speed of before hold.
TEST(LevelSink, GoesOnFromTheHeightThatAPilotLeftItAt) {
  Descent d(12.0, 0.0);
  d.run(3.0);
  d.sink.interrupt();
  d.up_m = 25.0;
  d.up_m_s = 0.0;
  d.fastest_m_s = 0.0;
  d.run(90.0);
  EXPECT_TRUE(d.touched);
  EXPECT_EQ(d.up_m, 0.0);
  EXPECT_LT(d.fastest_m_s, 1.5);
  EXPECT_LT(d.impact_m_s, 0.6);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
