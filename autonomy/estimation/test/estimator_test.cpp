// SPDX-License-Identifier: BSD-3-Clause
// The estimator around the filter: times, starts, lost sensors and rejected samples.
#include "autonomy/estimation/estimator.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

/// Stands for five seconds, then flies like multirotor_at(), whose clock starts smoothly within
/// four more.
Motion from_the_ground(double t) {
  constexpr double kStart_s = 5.0;
  constexpr double kRamp_s = 4.0;
  const double s = std::clamp((t - kStart_s) / kRamp_s, 0.0, 1.0);
  const double clock =
      kRamp_s * (s * s * s - 0.5 * s * s * s * s) + std::max(0.0, t - kStart_s - kRamp_s);
  const double rate = s * s * (3.0 - 2.0 * s);
  const double change = 6.0 * s * (1.0 - s) / kRamp_s;
  Motion m = multirotor_at(clock, 0.0);
  m.p_W.z() += 5.0;  // from the ground up
  m.a_W = rate * rate * m.a_W + change * m.v_W;
  m.v_W *= rate;
  m.q_WB = thrust_attitude(m.a_W, multirotor_heading(clock, 0.0));
  return m;
}

struct Fixture {
  explicit Fixture(double lag_s = 0.06, double gnss_delay_s = 0.03, Path path = from_the_ground) {
    WorldConfig config;
    config.filter.declination_rad = field_declination();
    config.filter.lag_s = lag_s;
    config.gnss_delay_s = gnss_delay_s;
    config.accel_bias_sigma = 0.05;
    config.range = false;
    world = std::make_unique<World>(config, std::move(path));
    estimator = std::make_unique<Estimator>(config.filter, Airframe::kMultirotor);
  }
  void run_until(double t_s) {
    while (world->time_s() < t_s) {
      estimator->set_at_rest(world->time_s() < rest_until_s);
      world->step(*estimator);
    }
  }
  /// Takes the samples while the link is cut.
  struct Nobody {
    template <class Sample>
    void add(const Sample&) {}
  };
  /// Horizontal error of the newest estimate against the truth at its own time.
  double position_error_m() const {
    const StateEstimate e = estimator->estimate();
    return (e.p_W - world->motion(e.t_s).p_W).head<2>().norm();
  }
  double velocity_error_m_s() const {
    const StateEstimate e = estimator->estimate();
    return (e.v_W - world->motion(e.t_s).v_W).norm();
  }
  double attitude_error_rad() const {
    const StateEstimate e = estimator->estimate();
    return e.q_WB.angularDistance(world->motion(e.t_s).q_WB);
  }
  const AidHealth& aid(Aid which) const { return estimator->health().of(which); }
  /// The link is cut until t_s.
  void silence_until(double t_s) {
    Nobody nobody;
    while (world->time_s() < t_s) world->step(nobody);
  }

  double rest_until_s{4.5};
  std::unique_ptr<World> world;
  std::unique_ptr<Estimator> estimator;
};

TEST(Estimator, StartsOnTheGroundAndKnowsItsBiases) {
  Fixture f;
  EXPECT_FALSE(f.estimator->estimate().usable());
  f.run_until(4.0);
  ASSERT_TRUE(f.estimator->initialised());
  EXPECT_FALSE(f.estimator->health().in_air_start);
  const StateEstimate e = f.estimator->estimate();
  EXPECT_TRUE(e.usable());
  EXPECT_NEAR(e.t_s, f.world->time_s() - kStep_s, 1e-9) << "the newest IMU sample";
  EXPECT_LT(f.velocity_error_m_s(), 0.05);
  EXPECT_LT(f.attitude_error_rad(), 0.05);
  EXPECT_LT((e.gyro_bias_B - f.world->truth_at(e.t_s).gyro_bias_B).norm(), 1e-3);
  f.run_until(30.0);
  EXPECT_LT(f.position_error_m(), 0.3);
  EXPECT_LT(f.velocity_error_m_s(), 0.2);
  EXPECT_LT(f.attitude_error_rad(), 0.03);
  EXPECT_EQ(f.estimator->health().late, 0U);
}

TEST(Estimator, StartsInTheAirWithoutAHintCoarselyThenFinds) {
  Fixture flying(0.06, 0.03, [](double t) { return multirotor_at(t + 3.0, 0.4); });
  flying.rest_until_s = -1.0;
  flying.run_until(3.0);
  ASSERT_TRUE(flying.estimator->initialised());
  EXPECT_TRUE(flying.estimator->health().in_air_start);
  flying.run_until(25.0);
  EXPECT_LT(flying.velocity_error_m_s(), 0.3);
  EXPECT_LT(flying.attitude_error_rad(), 0.06);
}

TEST(Estimator, LateMeasurementsAreFusedAtTheirOwnTime) {
  // At up to 4.6 m/s, half a second is 2 m: taken for new, the fixes would pull the position back.
  Fixture late(0.5, 0.45);
  late.run_until(40.0);
  EXPECT_LE(late.estimator->health().late, 5U) << "those from before the start";
  EXPECT_EQ(late.aid(Aid::kGnssHorizontal).rejected, 0U);
  double largest_m = 0.0;
  for (int k = 0; k < 100; ++k) {
    late.run_until(40.0 + 0.1 * k);
    largest_m = std::max(largest_m, late.position_error_m());
  }
  EXPECT_LT(largest_m, 0.35);
}

TEST(Estimator, GnssThatKeepsComingLateRaisesTheLag) {
  Fixture f(0.06, 0.5);
  f.run_until(40.0);
  EXPECT_EQ(f.estimator->estimate().horizontal, Quality::kGood);
  EXPECT_LE(f.estimator->health().late, 10U);
  double largest_m = 0.0;
  for (int k = 0; k < 100; ++k) {
    f.run_until(40.0 + 0.1 * k);
    largest_m = std::max(largest_m, f.position_error_m());
  }
  EXPECT_LT(largest_m, 0.5);
}

TEST(Estimator, WhatIsLaterThanTheLagIsCountedAndDropped) {
  Fixture f(0.02, 1.1);
  f.run_until(10.0);
  EXPECT_GT(f.estimator->health().late, 40U);
  EXPECT_EQ(f.aid(Aid::kGnssHorizontal).accepted, 0U);
}

TEST(Estimator, DeadReckonsThroughALossOfGnssAndSaysSo) {
  Fixture f;
  f.run_until(40.0);
  f.world->gnss_on = false;
  f.run_until(40.5);
  EXPECT_EQ(f.estimator->estimate().horizontal, Quality::kGood);
  f.run_until(42.0);
  EXPECT_EQ(f.estimator->estimate().horizontal, Quality::kDeadReckoned);
  EXPECT_NEAR(f.estimator->estimate().dead_reckoning_s, 2.0, 0.2);
  EXPECT_FALSE(f.estimator->estimate().position_unreliable);
  f.run_until(60.0);
  const StateEstimate e = f.estimator->estimate();
  EXPECT_LT(f.position_error_m(), 30.0);
  EXPECT_LT(f.position_error_m(), 4.0 * e.p_sigma_W_m.head<2>().norm()) << "knows how bad it is";
  f.run_until(75.0);
  EXPECT_EQ(f.estimator->estimate().horizontal, Quality::kNone);
  EXPECT_TRUE(f.estimator->estimate().position_unreliable) << "3 sigma above 15 m";
  f.world->gnss_on = true;
  f.run_until(95.0);
  EXPECT_FALSE(f.estimator->estimate().position_unreliable);
  EXPECT_LT(f.estimator->estimate().dead_reckoning_s, 0.2);
  EXPECT_EQ(f.estimator->estimate().horizontal, Quality::kGood);
  // The error of the satellites has moved on unseen, by 0.4 m in each axis (1 sigma).
  EXPECT_LT(f.position_error_m(), 3.0 * f.estimator->estimate().p_sigma_W_m.head<2>().norm());
  EXPECT_LT(f.position_error_m(), 2.0);
}

TEST(Estimator, SaysThatItBridgesUntilGnssAidsAgain) {
  Fixture f;
  f.run_until(30.0);
  EXPECT_FALSE(f.estimator->estimate().bridging);
  Fixture::Nobody nobody;
  while (f.world->time_s() < 30.5) f.world->step(nobody);
  f.run_until(30.52);
  EXPECT_TRUE(f.estimator->estimate().bridging);
  f.run_until(31.0);
  EXPECT_FALSE(f.estimator->estimate().bridging);
  EXPECT_LT(f.position_error_m(), 2.0);
}

TEST(Estimator, ShowsTheReturnOfGnssAsASlopeNotAStep) {
  Fixture f;
  f.run_until(40.0);
  f.world->gnss_on = false;
  f.world->extra_accel = {0.1, 0.0, 0.0};  // so that there is something to come back from
  f.run_until(60.0);
  ASSERT_GT(f.position_error_m(), 3.0);
  f.world->gnss_on = true;
  double before_m = f.position_error_m();
  for (int k = 0; k < 1000; ++k) {
    const double t = 60.0 + 0.01 * k;
    f.run_until(t);
    ASSERT_LT(std::abs(f.position_error_m() - before_m), 0.3) << t;  // else many metres
    before_m = f.position_error_m();
  }
}

TEST(Estimator, ABarometerStepIsRefusedThenLearned) {
  Fixture f;
  f.run_until(30.0);
  const double bias_m = f.estimator->estimate().baro_bias_m;
  f.world->extra_baro_m = 5.0;
  f.run_until(30.5);
  EXPECT_TRUE(f.aid(Aid::kBaro).rejecting);
  f.run_until(33.0);
  EXPECT_EQ(f.estimator->health().baro_relearned, 1U);
  const StateEstimate e = f.estimator->estimate();
  EXPECT_NEAR(e.baro_bias_m - bias_m, 5.0, 0.3);
  EXPECT_NEAR(e.p_W.z(), f.world->motion(e.t_s).p_W.z(), 0.5);
}

TEST(Estimator, AReceiverThatJumpsRightAfterAStartAtRestDoesNotMoveTheVehicle) {
  Fixture f;
  while (!f.estimator->initialised()) f.run_until(f.world->time_s() + 0.01);
  f.run_until(f.world->time_s() + 0.3);
  f.world->extra_gnss = {30.0, 0.0, 0.0};
  f.run_until(20.0);
  EXPECT_EQ(f.estimator->health().gnss_jumps, 1U);
  EXPECT_EQ(f.estimator->health().gnss_resets, 0U);
  EXPECT_LT(f.position_error_m(), 0.7);
}

TEST(Estimator, AReceiverThatJumpsDuringAnOutageLeavesThePositionUnreliable) {
  Fixture f;
  f.run_until(20.0);
  f.world->gnss_on = false;
  f.run_until(25.0);
  f.world->gnss_on = true;
  f.world->extra_gnss = {60.0, 0.0, 0.0};
  f.run_until(30.0);
  for (int k = 0; k < 60; ++k) {
    f.run_until(30.0 + k);
    const StateEstimate e = f.estimator->estimate();
    ASSERT_TRUE(e.position_unreliable) << k;
    ASSERT_LT(f.position_error_m(), 3.0 * e.p_sigma_W_m.head<2>().norm()) << k;
  }
  EXPECT_LT(f.velocity_error_m_s(), 0.3);
  f.world->extra_gnss.setZero();
  f.run_until(105.0);
  EXPECT_LT(f.position_error_m(), 1.0);
  EXPECT_FALSE(f.estimator->estimate().position_unreliable);
}

TEST(Estimator, ATurnedMagnetometerDoesNotTurnTheVehicle) {
  Fixture f;
  f.run_until(30.0);
  f.world->extra_heading_rad = 30.0 * kRadPerDeg;
  f.run_until(50.0);
  EXPECT_TRUE(f.aid(Aid::kHeading).rejecting);
  EXPECT_EQ(f.estimator->estimate().heading, Quality::kDeadReckoned);
  EXPECT_LT(f.attitude_error_rad(), 0.06);
  f.world->extra_heading_rad = 0.0;
  f.run_until(54.9);
  EXPECT_TRUE(f.aid(Aid::kHeading).rejecting);  // it has not fitted for 5 s yet
  f.run_until(56.0);
  EXPECT_FALSE(f.aid(Aid::kHeading).rejecting);
  EXPECT_EQ(f.estimator->estimate().heading, Quality::kGood);
}

TEST(Estimator, StepsOfTheImuAreFoundOut) {
  for (int axis = 0; axis < 3; ++axis) {
    Fixture gyro;
    gyro.run_until(30.0);
    gyro.world->extra_gyro = 0.02 * Vector3::Unit(axis);
    gyro.run_until(60.0);
    EXPECT_LT(gyro.position_error_m(), 0.5) << axis;
    EXPECT_LT(gyro.attitude_error_rad(), 0.06) << axis;
    Fixture accel;
    accel.run_until(30.0);
    accel.world->extra_accel = 0.3 * Vector3::Unit(axis);
    accel.run_until(60.0);
    EXPECT_LT(accel.position_error_m(), 0.5) << axis;
    EXPECT_LT(accel.attitude_error_rad(), 0.06) << axis;
  }
}

TEST(Estimator, RubbishIsCountedAndChangesNothing) {
  Fixture f;
  f.run_until(20.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double t = f.world->time_s();
  const Vector3 p_W = f.estimator->estimate().p_W;
  const std::uint64_t before = f.estimator->health().unusable;
  f.estimator->add(ImuSample{t, Vector3::Constant(nan), Vector3::Zero()});
  f.estimator->add(ImuSample{nan, Vector3::Zero(), Vector3::Zero()});
  f.estimator->add(ImuSample{t - 0.5, Vector3::Zero(), Vector3::Zero()});  // older than the last
  f.estimator->add(BaroSample{t, nan});
  f.estimator->add(BaroSample{t, 0.0});
  f.estimator->add(MagSample{t, Vector3::Zero()});
  GnssSample fix;
  fix.t_s = t;
  fix.fix_3d = true;
  fix.position = {nan, 0.0, 0.0};
  f.estimator->add(fix);
  fix.position = World::origin();
  fix.v_W_m_s = Vector3::Constant(nan);
  f.estimator->add(fix);
  EXPECT_EQ(f.estimator->health().unusable - before, 8U);
  EXPECT_EQ(f.estimator->estimate().p_W, p_W);
  f.run_until(25.0);
  EXPECT_LT(f.position_error_m(), 0.4);
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
