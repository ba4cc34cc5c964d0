// SPDX-License-Identifier: BSD-3-Clause
// The estimator goes on: through a cut link, a far end that restarts, a receiver that jumps, a gyro
// that is suddenly wrong, and anything a random sequence of samples may hold.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <limits>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

/// Takes the samples while the link is cut.
struct Nobody {
  template <class Sample>
  void add(const Sample&) {}
};

/// Passes samples on under the clock of a far end that has restarted, without those of some sensors.
struct Restarted {
  MultirotorEstimator& estimator;
  double earlier_s{};
  bool mag{true}, baro{true}, gnss{true};

  template <class Sample>
  void add(Sample sample) {
    if (std::is_same_v<Sample, MagSample> && !mag) return;
    if (std::is_same_v<Sample, BaroSample> && !baro) return;
    if (std::is_same_v<Sample, GnssSample> && !gnss) return;
    sample.t_s -= earlier_s;
    estimator.add(sample);
  }
};

constexpr double kRotorDrag_s_m = 0.05;
const Vector3 kWind_W(3.0, -2.0, 0.0);

/// The path of multirotor_at() with rotors that drag: the specific force along body x and y is
/// -drag thrust/mass times the velocity through the air.
Motion dragging_at(double t) {
  Motion m = multirotor_at(t, 0.4);
  const Vector3 force_W = m.a_W - Vector3(0.0, 0.0, kGravity);
  Vector3 z = -force_W.normalized();
  for (int k = 0; k < 12; ++k) {  // contracts by drag times airspeed, 0.3 at most
    z = -(force_W - kRotorDrag_s_m * force_W.dot(z) * (m.v_W - kWind_W)).normalized();
  }
  const double psi = multirotor_heading(t, 0.4);
  const Vector3 y = z.cross(Vector3(std::cos(psi), std::sin(psi), 0.0)).normalized();
  Matrix3 R;
  R << y.cross(z), y, z;
  m.q_WB = Quaternion(R);
  return m;
}

/// To and fro without drag, the tilt 0.5 rad to both sides and up to 1.5 rad/s.
Motion brisk_at(double t) {
  constexpr double kSize_m = 0.5, kRate_rad_s = 3.0;
  const double c = std::cos(kRate_rad_s * t), s = std::sin(kRate_rad_s * t);
  const Vector3 along_W(kSize_m, 0.3 * kSize_m, 0.0);
  Motion m;
  m.p_W = Vector3(0.0, 0.0, -5.0) + along_W * (1.0 - c);
  m.v_W = along_W * (kRate_rad_s * s);
  m.a_W = along_W * (kRate_rad_s * kRate_rad_s * c);
  m.q_WB = thrust_attitude(m.a_W, 0.3);
  return m;
}

struct Flight {
  /// `air_model`: what the estimator takes the drag of the rotors for, by their true one.
  explicit Flight(std::uint64_t seed = 1, double air_model = 0.0,
                  const Vector3& imu_position_B = Vector3::Zero(), const Path& path = dragging_at) {
    WorldConfig config;
    config.seed = seed;
    config.filter.air.rotor_drag_s_m = air_model * kRotorDrag_s_m;
    config.filter.declination_rad = field_declination();
    config.accel_bias_sigma = 0.03;
    config.gyro_bias_sigma = 0.005;
    config.range = false;
    config.filter.imu_position_B = imu_position_B;
    world = std::make_unique<World>(config, path);
    estimator = std::make_unique<MultirotorEstimator>(config.filter);
    ErrorStateEkf start;
    start.covariance().setZero();
    start.reset_variance(ErrorStateEkf::kTheta, 3, 0.02);
    start.reset_variance(ErrorStateEkf::kVelocity, 3, 0.1);
    start.reset_variance(ErrorStateEkf::kPosition, 3, 0.05);
    start.reset_variance(ErrorStateEkf::kGyroBias, 3, 0.005);
    start.reset_variance(ErrorStateEkf::kAccelBias, 3, 0.03);
    start.reset_variance(ErrorStateEkf::kBaroBias, 1, 0.05);
    start.reset_variance(ErrorStateEkf::kWind, 2, 4.0);
    start.reset_variance(ErrorStateEkf::kGnssBias, 3, 0.05);
    start.reset_variance(ErrorStateEkf::kMagBias, 3, 0.6);
    start.reset_variance(ErrorStateEkf::kAirScale, 2, 0.4);
    NominalState guess;
    guess.q_WB = world->motion(0.0).q_WB;
    guess.p_W = world->motion(0.0).p_W + guess.q_WB * imu_position_B;
    estimator->start_at(0.0, guess, start.covariance(), World::origin(),
                        World::pressure_at(World::origin().altitude_m - guess.p_W.z()));
  }
  void run_until(double t_s) {
    while (world->time_s() < t_s) world->step(*estimator);
  }
  void silence_until(double t_s) {
    Nobody nobody;
    while (world->time_s() < t_s) world->step(nobody);
  }
  /// Largest error of the attitude until t_s [rad].
  double worst_attitude_until(double t_s) {
    double worst_rad = 0.0;
    while (world->time_s() < t_s) {
      world->step(*estimator);
      worst_rad = std::max(worst_rad, attitude_error_rad());
    }
    return worst_rad;
  }
  Motion truth() const { return world->motion(world->time_s() - kStep_s); }
  double position_error_m() const { return (estimator->estimate().p_W - truth().p_W).norm(); }
  double velocity_error_m_s() const { return (estimator->estimate().v_W - truth().v_W).norm(); }
  double attitude_error_rad() const {
    return estimator->estimate().q_WB.angularDistance(truth().q_WB);
  }

  std::unique_ptr<World> world;
  std::unique_ptr<MultirotorEstimator> estimator;
};

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

TEST(Continuity, AReceiverThatJumpsDoesNotMoveTheVehicle) {
  Flight f;
  f.run_until(20.0);
  f.world->extra_gnss = {30.0, -10.0, 8.0};
  f.run_until(40.0);
  EXPECT_GE(f.estimator->health().gnss_jumps, 1U);
  EXPECT_LT(f.position_error_m(), 0.7);
  EXPECT_FALSE(f.estimator->estimate().position_unreliable);
  f.world->extra_gnss.setZero();
  f.run_until(60.0);
  EXPECT_LT(f.position_error_m(), 0.7);
  EXPECT_EQ(f.estimator->health().gnss_resets, 0U);
}

TEST(Continuity, GyroStepsUpToTheLimitAreLearnedBeforeTheAttitudeIsLost) {
  // Half the tilt limit of the shipped vehicles, 0.61 rad; beyond the stated limit of 0.1 a little more.
  for (const double step : {0.02, 0.1, 0.2}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        Flight f;
        f.run_until(20.0);
        f.world->extra_gyro = sign * step * Vector3::Unit(axis);
        EXPECT_LT(f.worst_attitude_until(25.0), step > 0.1 ? 0.4 : 0.3)
            << step << " about " << axis;
        f.run_until(35.0);
        const Vector3 bias = f.estimator->estimate().gyro_bias_B;
        const Vector3 true_bias = f.world->truth_at(f.estimator->filter_time_s()).gyro_bias_B;
        EXPECT_NEAR((bias - true_bias)(axis), sign * step, 0.003) << step << " about " << axis;
        EXPECT_LT(f.attitude_error_rad(), 0.05) << step << " about " << axis;
        EXPECT_LT(f.position_error_m(), 0.7) << step << " about " << axis;
      }
    }
  }
}

TEST(Continuity, WithoutGnssTheForceOfTheAirHoldsTheAttitude) {
  for (const double step : {0.0, 0.02, 0.1}) {
    for (int axis = 0; axis < 2; ++axis) {
      std::array<double, 2> off_m{}, turned_rad{};
      for (const bool drag : {false, true}) {
        Flight f(1, drag);
        f.run_until(25.0);
        f.world->gnss_on = false;
        f.world->extra_gyro = step * Vector3::Unit(axis);
        turned_rad[drag ? 1U : 0U] = f.worst_attitude_until(45.0);
        off_m[drag ? 1U : 0U] = f.position_error_m();
      }
      std::printf(
          "step %.2f about %d: %.1f m and %.3f rad, without air force %.1f m and %.3f rad\n", step,
          axis, off_m[1], turned_rad[1], off_m[0], turned_rad[0]);
      EXPECT_LT(off_m[1], 25.0) << step << " about " << axis;
      EXPECT_LT(turned_rad[1], 0.3) << step << " about " << axis;
      EXPECT_LT(off_m[1], (step > 0.0 ? 0.3 : 1.5) * off_m[0]) << step << " about " << axis;
    }
  }
}

TEST(Continuity, GustsWidenTheWindAndStillAirNarrowsIt) {
  for (const bool gusty : {false, true}) {
    Flight f(1, 1.0);
    f.run_until(20.0);
    double nis = 0.0;
    int count = 0;
    for (int k = 0; k < 2000; ++k) {
      // What a gust does to the accelerometer, 0.4 m/s^2 for some tenths of a second.
      f.world->extra_accel.x() = gusty ? 0.4 * std::sin(0.05 * k) : 0.0;
      f.world->step(*f.estimator);
      nis += f.estimator->health().of(Aid::kSideslip).nis;
      ++count;
    }
    EXPECT_LT(nis / count, 2.0) << gusty;
    EXPECT_LT(f.attitude_error_rad(), 0.06) << gusty;
  }
}

TEST(Continuity, TheDragOfTheVehicleFileMayBeFarFromTheTrueOne) {
  for (const double air_model : {0.5, 1.0, 2.0, 3.0}) {
    Flight f(1, air_model);
    EXPECT_LT(f.worst_attitude_until(40.0), 0.06) << air_model;
    EXPECT_LT(f.velocity_error_m_s(), 0.3) << air_model;
    const Vector2 scale = f.estimator->filter().state().air_scale_B;
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_NEAR((1.0 + scale(axis)) * air_model, 1.0, 0.15) << axis << " of " << air_model;
    }
  }
}

TEST(Continuity, TheAntennaMayBeBesideItsPlace) {
  for (const Vector3& beside_m : {Vector3(0.12, 0.0, 0.08), Vector3(-0.08, 0.1, 0.0)}) {
    Flight f(1, 0.0, Vector3::Zero(), brisk_at);
    f.world->gnss_beside_m = beside_m;
    EXPECT_LT(f.worst_attitude_until(60.0), 0.06);
    EXPECT_EQ(f.estimator->health().imu_widenings, 0U);
  }
}

TEST(Continuity, AMagnetometerThatTurnsIsNotTakenForAGyro) {
  for (const double turn_deg : {30.0, 90.0, 180.0, -45.0}) {
    Flight f;
    f.run_until(20.0);
    f.world->extra_heading_rad = turn_deg * kRadPerDeg;
    EXPECT_LT(f.worst_attitude_until(50.0), 0.08) << turn_deg;
    EXPECT_EQ(f.estimator->health().heading_widenings, 0U) << turn_deg;
  }
}

TEST(Continuity, AMagnetometerThatTurnsWhileTiltedIsNotTakenForAGyroEither) {
  // Turned about body z in a bank, it moves the heading by anything from nothing to twice the turn,
  // and the rest comes when the vehicle levels out: at a glance a gyro that drifts. Where the bank
  // hides the whole turn and then goes slowly, the heading follows; position and velocity do not.
  int followed = 0, flights = 0;
  for (int start = 0; start < 24; ++start) {
    for (const double turn_deg : {30.0, -30.0}) {
      Flight f;
      f.run_until(20.0 + 0.25 * start);
      f.world->turned_mag_rad = turn_deg * kRadPerDeg;
      followed += f.worst_attitude_until(40.0) > 0.12 ? 1 : 0;
      ++flights;
      EXPECT_LT(f.position_error_m(), 1.0) << turn_deg << " after " << start;
      EXPECT_LT(f.velocity_error_m_s(), 1.0) << turn_deg << " after " << start;
    }
  }
  EXPECT_LT(followed, flights / 10);
}

TEST(Continuity, TurningDoesNotReachTheForceOfTheAir) {
  // Half a metre from the origin: what turning adds is up to 2 m/s^2, 30 times the noise.
  Flight f(1, 1.0, {0.0, 0.3, -0.5});
  f.run_until(20.0);
  const std::uint64_t rejected = f.estimator->health().of(Aid::kSideslip).rejected;
  double nis = 0.0;
  int count = 0;
  while (f.world->time_s() < 40.0) {
    f.world->step(*f.estimator);
    nis += f.estimator->health().of(Aid::kSideslip).nis;
    ++count;
  }
  EXPECT_LT(nis / count, 1.3);
  EXPECT_EQ(f.estimator->health().of(Aid::kSideslip).rejected, rejected);
}

TEST(InnovationMean, FindsABiasThatSquaresDoNotShow) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    InnovationMean mean(0.1, 5.0);
    int alarms = 0;
    for (int k = 0; k < 100'000; ++k) alarms += mean.exceeded(normal(random)) ? 1 : 0;
    EXPECT_LE(alarms, 1) << "white: beyond 5 sigma";
    int samples = 0;
    while (!mean.exceeded(2.0 + normal(random))) ++samples;
    EXPECT_LT(samples, 25) << "two sigma off";
  }
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
      ASSERT_GT(P.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-6 * P.norm())
          << seed;
    }
  }
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
