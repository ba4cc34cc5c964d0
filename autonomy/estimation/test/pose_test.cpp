// SPDX-License-Identifier: BSD-3-Clause
// The estimator on poses of motion capture alone: no satellites, no declination known beforehand.
#include <gtest/gtest.h>

#include <deque>
#include <limits>
#include <memory>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

/// Stands for five seconds, then flies like multirotor_at() from the ground up.
Motion take_off(double t) {
  constexpr double kStart_s = 5.0;
  constexpr double kRamp_s = 4.0;
  const double s = std::clamp((t - kStart_s) / kRamp_s, 0.0, 1.0);
  const double clock =
      kRamp_s * (s * s * s - 0.5 * s * s * s * s) + std::max(0.0, t - kStart_s - kRamp_s);
  const double rate = s * s * (3.0 - 2.0 * s);
  const double change = 6.0 * s * (1.0 - s) / kRamp_s;
  Motion m = multirotor_at(clock, 0.0);
  m.p_W += Vector3(2.0, -1.0, 5.0);  // not at the origin of the room
  m.a_W = rate * rate * m.a_W + change * m.v_W;
  m.v_W *= rate;
  m.q_WB = thrust_attitude(m.a_W, multirotor_heading(clock, 0.0));
  return m;
}

struct Room {
  explicit Room(double delay = 0.05, std::uint64_t seed = 1) : delay_s{delay} {
    WorldConfig config;
    config.seed = seed;
    config.accel_bias_sigma = 0.05;
    config.mag_bias_sigma_T = 0.0;
    config.range = false;
    filter = config.filter;
    world = std::make_unique<World>(config, take_off);
    world->gnss_on = false;
    estimator = std::make_unique<Estimator>(config.filter, Airframe::kMultirotor);
  }
  PoseSample pose(double t) {
    const Motion m = world->motion(t);
    const double turn = filter.pose_heading_sigma_rad * world->normal() + extra_heading_rad;
    return {t, m.p_W + extra_p_W + filter.pose_position_sigma_m * world->normal3(),
            exp_rotation({0.0, 0.0, turn}) * m.q_WB};
  }
  void run_until(double t_s) {
    while (world->time_s() < t_s) {
      const double now = world->time_s();
      if (seen && std::lround(now / kStep_s) % 4 == 0) waiting.push_back(pose(now));
      while (!waiting.empty() && waiting.front().t_s + delay_s <= now + 1e-9) {
        estimator->add(waiting.front());
        waiting.pop_front();
      }
      estimator->set_at_rest(now < 4.5);
      world->step(*estimator);
    }
  }
  double position_error_m() const {
    const StateEstimate e = estimator->estimate();
    return (e.p_W - world->motion(e.t_s).p_W).norm();
  }
  double heading_error_rad() const {
    const StateEstimate e = estimator->estimate();
    return std::abs(log_rotation(e.q_WB * world->motion(e.t_s).q_WB.conjugate()).z());
  }
  const AidHealth& aid(Aid which) const { return estimator->health().of(which); }

  double delay_s;
  bool seen{true};
  Vector3 extra_p_W{Vector3::Zero()};
  double extra_heading_rad{};
  EstimatorConfig filter;
  std::deque<PoseSample> waiting;
  std::unique_ptr<World> world;
  std::unique_ptr<Estimator> estimator;
};

TEST(Pose, StartsWithoutSatellitesWhereTheCamerasHaveIt) {
  Room room;
  room.run_until(4.0);
  ASSERT_TRUE(room.estimator->initialised());
  EXPECT_LT(room.position_error_m(), 0.02);
  EXPECT_LT(room.heading_error_rad(), 0.03);
  EXPECT_FALSE(room.estimator->origin().has_value());
  EXPECT_TRUE(room.estimator->estimate().usable());
}

TEST(Pose, CarriesAFlightAndItsInnovationsAreAsLargeAsTheyShouldBe) {
  double nis = 0.0;
  double heading_nis = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Room room(0.05, seed);
    room.run_until(10.0);
    std::uint64_t seen = room.aid(Aid::kPose).accepted;
    const std::uint64_t late = room.estimator->health().late;
    EXPECT_LE(late, 5U);  // those that were on the way at the start
    for (double t = 10.0; t < 40.0; t += 0.0101) {
      room.run_until(t);
      ASSERT_LT(room.position_error_m(), 0.03) << t;
      ASSERT_LT(room.heading_error_rad(), 0.05) << t;
      if (room.aid(Aid::kPose).accepted == seen) continue;
      seen = room.aid(Aid::kPose).accepted;
      nis += room.aid(Aid::kPose).nis;
      heading_nis += room.aid(Aid::kPoseHeading).nis;
      ++count;
    }
    EXPECT_EQ(room.aid(Aid::kPose).rejected, 0U);
    EXPECT_EQ(room.aid(Aid::kGnssVelocity).accepted, 0U);
    EXPECT_EQ(room.estimator->health().late, late);
  }
  // Mean of n squares of normal numbers: spread sqrt(2/n), of three of them sqrt(2/(3 n)).
  EXPECT_NEAR(nis / count, 1.0, 4.0 * std::sqrt(2.0 / 3.0 / count));
  EXPECT_NEAR(heading_nis / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST(Pose, OneThatIsLaterThanTheFilterRaisesItsLag) {
  Room room(0.2);
  room.run_until(20.0);
  EXPECT_GT(room.estimator->health().late, 0U);
  const std::uint64_t late = room.estimator->health().late;
  room.run_until(30.0);
  EXPECT_EQ(room.estimator->health().late, late);
  EXPECT_LT(room.position_error_m(), 0.05);
}

TEST(Pose, ADropOutOfHalfASecondIsBridged) {
  Room room;
  room.run_until(15.0);
  for (double t = 15.0; t < 30.0; t += 2.5) {
    room.seen = false;
    for (double end = t + 0.5; t < end; t += 0.05) {
      room.run_until(t);
      EXPECT_LT(room.position_error_m(), 4.0 * room.estimator->estimate().p_sigma_W_m.norm()) << t;
      EXPECT_LT(room.position_error_m(), 0.15) << t;  // 0.3 m/s, wrong for the whole of it
    }
    room.seen = true;
    room.run_until(t + 0.5);
    EXPECT_EQ(room.estimator->estimate().horizontal, Quality::kGood);
  }
  EXPECT_EQ(room.aid(Aid::kPose).rejected, 0U);
}

TEST(Pose, ALongLossIsReportedAndReturnsWithoutAStep) {
  Room room;
  room.run_until(15.0);
  room.seen = false;
  room.run_until(20.0);
  EXPECT_EQ(room.estimator->estimate().horizontal, Quality::kDeadReckoned);
  EXPECT_NEAR(room.estimator->estimate().dead_reckoning_s, 5.0, 0.15);
  const StateEstimate lost = room.estimator->estimate();
  const double off_m = room.position_error_m();
  EXPECT_LT(off_m, 4.0 * lost.p_sigma_W_m.norm());
  EXPECT_GT(off_m, 0.15);  // more than the step allowed below
  room.seen = true;
  Vector3 before_W = lost.p_W - room.world->motion(lost.t_s).p_W;
  for (double t = 20.01; t < 24.0; t += 0.01) {
    room.run_until(t);
    const StateEstimate e = room.estimator->estimate();
    const Vector3 error_W = e.p_W - room.world->motion(e.t_s).p_W;
    // At jump_speed_m_s from the time of the filter on, which is lag_s before that of the output.
    const double shown_m = room.filter.jump_speed_m_s * (room.filter.lag_s + 0.02);
    EXPECT_LT((error_W - before_W).head<2>().norm(), shown_m) << t;
    before_W = error_W;
  }
  EXPECT_LT(room.position_error_m(), 0.05);
  EXPECT_EQ(room.estimator->estimate().horizontal, Quality::kGood);
}

TEST(Pose, AWrongOneIsRejectedAndARoomThatMovedIsFollowed) {
  Room room;
  room.run_until(15.0);
  room.extra_p_W = {5.0, 0.0, 0.0};
  room.run_until(15.3);
  EXPECT_LT(room.position_error_m(), 0.1);
  EXPECT_GT(room.aid(Aid::kPose).rejected, 0U);
  room.run_until(20.0);  // pose_reset_s is 0.5 s
  EXPECT_NEAR(room.position_error_m(), 5.0, 0.1);
  EXPECT_EQ(room.estimator->health().gnss_resets, 1U);
}

TEST(Pose, WhatIsNoPoseIsNotUsed) {
  Room room;
  room.run_until(15.0);
  const std::uint64_t unusable = room.estimator->health().unusable;
  PoseSample bad = room.pose(15.0);
  bad.p_W.x() = std::numeric_limits<double>::quiet_NaN();
  room.estimator->add(bad);
  bad = room.pose(15.0);
  bad.q_WB.coeffs().setZero();
  room.estimator->add(bad);
  EXPECT_EQ(room.estimator->health().unusable, unusable + 2);
  EXPECT_LT(room.position_error_m(), 0.05);
}

TEST(Pose, CanBeLeftOut) {
  Room room;
  EstimatorConfig config = room.filter;
  config.use_pose = false;
  room.estimator = std::make_unique<Estimator>(config, Airframe::kMultirotor);
  room.run_until(5.0);
  EXPECT_FALSE(room.estimator->initialised());
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
