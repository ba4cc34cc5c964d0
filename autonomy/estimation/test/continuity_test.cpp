// SPDX-License-Identifier: BSD-3-Clause
// The estimator goes on: through a cut link, a far end that restarts, and anything a random sequence of
// samples may hold.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <limits>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/continuity_rig.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

TEST(Continuity, ACutLinkIsBridgedAndTheCovarianceSaysHowWell) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Flight f(seed);
    f.run_until(20.0);
    f.silence_until(23.0);
    f.run_until(23.02);
    StateEstimate e = f.estimator->estimate();
    EXPECT_TRUE(e.usable());
    EXPECT_TRUE(e.bridging);
    EXPECT_GT(e.dead_reckoning_s, 2.5);
    // The eight turns meanwhile, but neither error is a surprise.
    f.run_until(23.09);
    e = f.estimator->estimate();
    EXPECT_LT((e.p_W - f.truth().p_W).head<2>().norm(), 3.0 * e.p_sigma_W_m.head<2>().norm());
    EXPECT_LT((e.v_W - f.truth().v_W).head<2>().norm(), 3.0 * e.v_sigma_W_m_s.head<2>().norm());
    f.estimator->set_attitude_hint(f.world->time_s(), f.truth().q_WB);
    f.run_until(24.0);
    EXPECT_FALSE(f.estimator->estimate().bridging);
    EXPECT_LT(f.velocity_error_m_s(), 0.5) << seed;
    f.run_until(30.0);
    EXPECT_LT(f.position_error_m(), 0.7) << seed;
    EXPECT_LT(f.attitude_error_rad(), 0.06) << seed;
    EXPECT_EQ(f.estimator->health().restarts, 0U);
  }
}

TEST(Continuity, ARestartOfTheFarEndMovesTheTimesAndNothingElse) {
  Flight f;
  f.run_until(20.0);
  const Geodetic origin = f.estimator->origin().value_or(Geodetic{});
  f.silence_until(20.1);
  Restarted clock{*f.estimator, 20.05};
  while (f.world->time_s() < 22.0) {
    f.world->step(clock);
    EXPECT_TRUE(f.estimator->initialised());
  }
  const StateEstimate e = f.estimator->estimate();
  EXPECT_NEAR(e.t_s, f.world->time_s() - kStep_s - 20.05, 1e-9) << "of the samples";
  EXPECT_EQ(f.estimator->health().realigned, 1U);
  EXPECT_LT((e.p_W - f.truth().p_W).norm(), 0.5);
  EXPECT_LT(f.attitude_error_rad(), 0.06);
  EXPECT_EQ(f.estimator->origin().value_or(Geodetic{}).latitude_deg, origin.latitude_deg);
}

TEST(Continuity, ARestartNeedsNoSensorButTheImu) {
  for (int missing = 0; missing < 4; ++missing) {
    Flight f;
    f.run_until(20.0);
    f.silence_until(20.1);
    Restarted clock{*f.estimator, 20.05, missing != 0, missing != 1, missing != 2};
    if (missing == 3) clock.mag = clock.baro = clock.gnss = false;
    while (f.world->time_s() < 22.0) f.world->step(clock);
    const StateEstimate e = f.estimator->estimate();
    EXPECT_TRUE(e.usable()) << missing;
    EXPECT_LT((e.p_W - f.truth().p_W).norm(), 3.0 * e.p_sigma_W_m.norm() + 0.5) << missing;
    EXPECT_LT(f.attitude_error_rad(), 0.1) << missing;
  }
}

TEST(Continuity, TheHeadingOfAFarEndThatHasRestartedIsNotTaken) {
  for (const double turned_rad : {0.0, 1.0, 3.0}) {
    Flight f;
    f.run_until(20.0);
    f.silence_until(23.0);
    f.run_until(23.09);
    const Quaternion turned(Eigen::AngleAxisd(turned_rad, Vector3::UnitZ()));
    f.estimator->set_attitude_hint(f.world->time_s(), turned * f.truth().q_WB, false);
    f.run_until(25.0);
    EXPECT_LT(f.attitude_error_rad(), 0.15) << turned_rad;
    f.run_until(30.0);
    EXPECT_LT(f.attitude_error_rad(), 0.06) << turned_rad;
    EXPECT_LT(f.position_error_m(), 0.7) << turned_rad;
  }
}

TEST(Continuity, ABarometerThatHasJumpedInALongHoleDoesNotMoveTheAltitude) {
  for (const double jump_m : {5.0, -10.0}) {
    Flight f;
    f.run_until(20.0);
    f.world->extra_baro_m = jump_m;
    f.silence_until(23.0);
    f.run_until(24.0);
    EXPECT_LT(std::abs((f.estimator->estimate().p_W - f.truth().p_W).z()), 1.0) << jump_m;
    f.run_until(30.0);
    EXPECT_LT(std::abs((f.estimator->estimate().p_W - f.truth().p_W).z()), 1.0) << jump_m;
  }
}

TEST(Continuity, WithoutGnssAStepOfTheAccelerometerIsNotTheBarometers) {
  for (const double step_m_s2 : {0.5, 1.0, 3.0, -3.0, 5.0}) {
    Flight f(1, 1.0);
    f.run_until(25.0);
    f.world->gnss_on = false;
    f.world->extra_accel.z() = step_m_s2;
    f.run_until(45.0);
    const StateEstimate e = f.estimator->estimate();
    EXPECT_EQ(f.estimator->health().baro_relearned, 0U) << step_m_s2;
    EXPECT_LT(std::abs(e.p_W.z() - f.truth().p_W.z()), 0.6) << step_m_s2;
    EXPECT_LT(std::abs(e.v_W.z() - f.truth().v_W.z()), 0.3) << step_m_s2;
    EXPECT_NEAR(e.accel_bias_B.z(), step_m_s2, 0.3);
  }
}

TEST(Continuity, WithoutGnssABarometerThatJumpsIsStillLearned) {
  for (const double step_m : {5.0, -10.0, 50.0}) {
    Flight f(1, 1.0);
    f.run_until(25.0);
    f.world->gnss_on = false;
    f.world->extra_baro_m = step_m;
    f.run_until(35.0);
    EXPECT_GE(f.estimator->health().baro_relearned, 1U) << step_m;
    EXPECT_LT(std::abs(f.estimator->estimate().p_W.z() - f.truth().p_W.z()), 1.5) << step_m;
  }
}

TEST(Continuity, SingleSamplesOfAnotherClockChangeNothing) {
  Flight f;
  f.run_until(20.0);
  for (const double t_s : {5000.0, 0.01, 0.0125, 9.0, -3.0}) {
    f.estimator->add(ImuSample{t_s, Vector3::Zero(), Vector3(0.0, 0.0, -kGravity)});
  }
  f.run_until(25.0);
  EXPECT_EQ(f.estimator->health().realigned, 0U);
  EXPECT_LT(f.position_error_m(), 0.3);
}

TEST(Continuity, RandomSequencesNeverBreakTheInvariants) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Flight f(seed);
    std::mt19937_64 random(seed);
    const auto uniform = [&random](double low, double high) {
      return std::uniform_real_distribution<double>{low, high}(random);
    };
    double earlier_s = 0.0;
    f.run_until(3.0);
    for (int event = 0; event < 40; ++event) {
      Restarted clock{*f.estimator, earlier_s, uniform(0, 1) > 0.3, uniform(0, 1) > 0.3,
                      uniform(0, 1) > 0.3};
      const double until_s = f.world->time_s() + uniform(0.05, 0.8);
      while (f.world->time_s() < until_s) f.world->step(clock);
      switch (static_cast<int>(uniform(0.0, 8.0))) {
        case 0:
          f.silence_until(f.world->time_s() + uniform(0.0, 4.0));
          break;
        case 1:
          earlier_s = uniform(-100.0, 100.0);
          break;
        case 2:
          f.world->extra_gyro = 0.5 * f.world->normal3();
          break;
        case 3:
          f.world->extra_accel = 3.0 * f.world->normal3();
          break;
        case 4:
          f.world->extra_gnss = 100.0 * f.world->normal3();
          break;
        case 5:
          f.world->extra_heading_rad = uniform(-3.0, 3.0);
          break;
        case 6:
          f.world->extra_baro_m = uniform(-50.0, 50.0);
          break;
        default:
          f.estimator->add(ImuSample{uniform(-10.0, 1e4), Vector3::Constant(uniform(-60.0, 60.0)),
                                     Vector3::Constant(uniform(0, 1) > 0.5 ? nan : 400.0)});
          f.estimator->add(BaroSample{uniform(-10.0, 1e4), uniform(0.0, 2e5)});
          f.estimator->set_attitude_hint(f.estimator->estimate().t_s,
                                         Quaternion(1.0, uniform(-1, 1), uniform(-1, 1), nan));
      }
      const StateEstimate e = f.estimator->estimate();
      ASSERT_TRUE(e.p_W.allFinite() && e.v_W.allFinite() && e.w_B.allFinite()) << seed;
      ASSERT_NEAR(e.q_WB.norm(), 1.0, 1e-9) << seed;
      ASSERT_TRUE(e.usable() || e.dead_reckoning_s > 0.0) << seed;
      ASSERT_GE(e.p_sigma_W_m.minCoeff(), 0.0) << seed;
      const auto& P = f.estimator->filter().covariance();
      ASSERT_LT((P - P.transpose()).norm(), 1e-9 * P.norm()) << seed;
      // No eigenvalue of P is below -1e-6 of its norm: lifted by that, it has a Cholesky factor.
      Eigen::MatrixXd lifted = P;
      lifted.diagonal().array() += 1e-6 * P.norm();
      ASSERT_EQ(lifted.llt().info(), Eigen::Success) << seed;
    }
  }
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
