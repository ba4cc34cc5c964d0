// SPDX-License-Identifier: BSD-3-Clause
#include <utility>
#include <vector>

#include "firmware/core/test/estimator_rig.hpp"

namespace rosflight::core {
namespace {

// ---- accelerometer

TEST(EstimatorAccelerometer, IsIgnoredOutsideItsMargin) {
  // Tilted by 0.3 rad but 10 % too strong or weak: no correction. 9.9 %: correction.
  const auto roll_after = [](float scale) {
    Rig rig(2500);
    hal::Vec3 a = Attitude::from_euler(0.3, 0, 0).accel_at_rest();
    for (float& v : a) v *= scale;
    rig.rest(3.0, a);
    return rig.estimator.estimate().roll_rad;
  };
  EXPECT_GT(roll_after(1.099f), 0.25f);
  EXPECT_GT(roll_after(0.901f), 0.25f);
  // The low-passed acceleration starts at 1 g and passes the margin within a few samples.
  EXPECT_LT(roll_after(1.2f), 0.02f);
  EXPECT_LT(roll_after(0.8f), 0.02f);
}

TEST(EstimatorAccelerometer, DoesNotTouchYawOrItsBias) {
  Rig rig(2500);
  rig.rest(0.01);
  rig.rest(20.0, Attitude::from_euler(0.2, -0.3, 0).accel_at_rest());
  EXPECT_EQ(rig.estimator.bias_rad_s().z(), 0.0f);
  // Turning about x and y only, yaw moves by the area that the nose's path encloses: 0.2 * 0.3 / 2.
  EXPECT_NEAR(std::abs(yaw_of(rig.q())), 0.03f, 0.005f);
}

TEST(EstimatorAccelerometer, OneStepTurnsByTheSineOfTheError) {
  // At heading 0 as ROSflight 2.x: k_p sin(error) dt, here for a level estimate.
  for (const double roll : {0.01, 0.1, -0.5, 1.5}) {
    Estimator::Config config = unboosted();
    config.ki = 0.0f;
    Rig rig(2500, config);
    rig.sample(kLevel, {});
    rig.sample(Attitude::from_euler(roll, 0, 0).accel_at_rest(), {});
    EXPECT_NEAR(rig.estimator.estimate().roll_rad, 0.5 * 0.0025 * std::sin(roll), 1e-7) << roll;
  }
}

TEST(EstimatorAccelerometer, ConvergesTheSameAtEveryHeading) {
  for (const double tilt_deg : {2.0, 10.0, 45.0, 89.0, 120.0, 170.0}) {
    for (const double direction_deg : {0.0, 60.0, 90.0, 200.0}) {
      std::vector<double> left;
      for (int eighth = 0; eighth < 8; ++eighth) {
        Estimator::Config config = unboosted();
        config.ki = 0.0f;  // no overshoot
        Rig rig(2500, config);
        rig.sample(kLevel, {});
        const Attitude start = Attitude::from_euler(0.1, -0.2, eighth * 45 * kDegree);
        turn_to(rig, start);
        const double d = direction_deg * kDegree;
        const Attitude truth_q = start.turned({std::cos(d), std::sin(d), 0.0}, tilt_deg * kDegree);
        rig.rest(2.0, truth_q.accel_at_rest());
        left.push_back(tilt_error_deg(rig.q(), truth_q));
        rig.rest(10.0, truth_q.accel_at_rest());
        EXPECT_LT(tilt_error_deg(rig.q(), truth_q), 1.5) << tilt_deg << " at " << eighth;
      }
      // The slowest law allowed: one time constant of 2 s, from the far side at most 1 rad/s k_p.
      EXPECT_LT(left[0], tilt_deg > 60 ? tilt_deg - 20 : 0.5 * tilt_deg);
      for (const double e : left) EXPECT_NEAR(e, left[0], 0.01) << tilt_deg << " " << direction_deg;
    }
  }
}

TEST(EstimatorAccelerometer, ConvergesOnItsSideAndStandingOnItsTail) {
  // There body z lies in the horizontal plane: an error about it is one of roll and pitch.
  for (const Attitude& truth_q :
       {Attitude::from_euler(90 * kDegree, 0, 1), Attitude::from_euler(0, 90 * kDegree, 0),
        Attitude::from_euler(-90 * kDegree, 0.3, 3), Attitude::from_euler(180 * kDegree, 0.1, 2)}) {
    for (const Rates& axis : {Rates{1, 0, 0}, Rates{0, 1, 0}, Rates{0, 0, 1}}) {
      Rig rig(2500, unboosted());
      rig.sample(kLevel, {});
      turn_to(rig, truth_q.turned(axis, 0.35));
      rig.rest(15.0, truth_q.accel_at_rest());
      EXPECT_LT(tilt_error_deg(rig.q(), truth_q), 1.0);
      EXPECT_EQ(rig.estimator.bias_rad_s().z(), 0.0f);
    }
  }
}

TEST(EstimatorAccelerometer, AGyroErrorDoesNotTiltAnyHeading) {
  // 0.29 deg/s at k_p = 0.5: 0.58 degrees, which the bias then takes away.
  for (const double heading_deg : {0.0, 90.0, 180.0, 270.0}) {
    Rig rig(2500, unboosted());
    const Attitude truth_q = Attitude::from_euler(0, 0, heading_deg * kDegree);
    rig.sample(kLevel, {});
    turn_to(rig, truth_q);
    const auto offset = static_cast<float>(0.29 * kDegree);
    rig.rest(120.0, kLevel, {offset, offset, 0.0f});
    EXPECT_LT(tilt_error_deg(rig.q(), truth_q), 1.0) << heading_deg;
  }
}

TEST(EstimatorAccelerometer, ExactlyLevelCorrectsAsAnyOther) {
  for (const hal::Vec3& level : {kLevel, hal::Vec3{0.002f, -0.002f, -9.80665f}}) {
    Rig rig(2500, unboosted());
    rig.sample(kLevel, {});
    turn_to(rig, Attitude::from_euler(20 * kDegree, 0, 2));
    rig.rest(10.0, level);
    EXPECT_LT(tilt_error_deg(rig.q(), Attitude{}), 1.0);
  }
}

TEST(EstimatorAccelerometer, UpsideDownRightsItself) {
  Estimator::Config config = unboosted();
  config.ki = 0.0f;
  for (const Attitude& wrong :
       {Attitude::from_euler(180 * kDegree, 0, 0), Attitude::from_euler(0, 180 * kDegree, 0),
        Attitude::from_euler(179.9 * kDegree, 0.1 * kDegree, 2)}) {
    Rig rig(2500, config);
    rig.sample(kLevel, {});
    turn_to(rig, wrong);
    rig.rest(1.0);
    // 0.5 rad/s from the first sample on.
    EXPECT_LT(tilt_error_deg(rig.q(), Attitude{}), 152.0);
    rig.rest(20.0);
    EXPECT_LT(tilt_error_deg(rig.q(), Attitude{}), 1.0);
  }
  Rig rig(2500, config);
  rig.rest(20.0, {0.0f, 0.0f, 9.80665f});  // the other way about
  EXPECT_NEAR(squared_norm(rig.q()), 1.0f, 1e-6f);
  EXPECT_LT(tilt_error_deg(rig.q(), Attitude::from_euler(180 * kDegree, 0, 0)), 1.0);
}

TEST(EstimatorAccelerometer, NoAccelerationAtAllIsNotUsed) {
  Rig rig(2500);
  rig.rest(2.0, {});
  EXPECT_EQ(rig.q().w, 1.0f);
  EXPECT_TRUE(std::isfinite(rig.estimator.bias_rad_s().norm()));
}

// ---- external attitude

TEST(EstimatorExternalAttitude, OneMeasurementAfterSilenceDoesNotOvershoot) {
  // Weak point 21: in ROSflight 2.x 0.2 rad of yaw after 1 s of silence became 0.55 rad.
  for (const double silence_s : {0.1, 1.0, 10.0}) {
    Estimator::Config config;
    config.init_time = Time{0};
    Rig rig(2500, config);
    rig.rest(silence_s);
    ASSERT_TRUE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, 0.2).floats()));
    rig.rest(0.1);
    EXPECT_GT(yaw_of(rig.q()), 0.05f) << silence_s;
    EXPECT_LT(yaw_of(rig.q()), 0.2001f) << silence_s;
  }
}

TEST(EstimatorExternalAttitude, LongSilenceClosesTheGapAtOnce) {
  Estimator::Config config;
  config.init_time = Time{0};
  Rig rig(2500, config);
  rig.rest(1.0);
  ASSERT_TRUE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, 0.2).floats()));
  rig.sample(kLevel, {});
  // k_p times 2 sin(0.2) times 1/(2 k_p) = sin(0.2) = 0.19867
  EXPECT_NEAR(yaw_of(rig.q()), 0.19867f, 1e-4f);
}

TEST(EstimatorExternalAttitude, CorrectsInProportionToTheInterval) {
  Estimator::Config config;
  config.init_time = Time{0};
  config.ki = 0.0f;
  Rig rig(2500, config);
  rig.rest(0.1);
  ASSERT_TRUE(rig.estimator.set_external_attitude({1, 0, 0, 0}));
  rig.sample(kLevel, {});
  rig.rest(0.0175);
  ASSERT_TRUE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, 0.1).floats()));
  rig.sample(kLevel, {});
  // 20 ms since the previous one: 1.5 * 2 sin(0.1) * 0.02
  EXPECT_NEAR(yaw_of(rig.q()), 1.5f * 2.0f * 0.0998334f * 0.02f, 2e-6f);
}

TEST(EstimatorExternalAttitude, IsUsedOnce) {
  Estimator::Config config;
  config.init_time = Time{0};
  config.ki = 0.0f;
  Rig rig(2500, config);
  rig.rest(0.1);
  ASSERT_TRUE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, 0.1).floats()));
  rig.sample(kLevel, {});
  const float once = yaw_of(rig.q());
  EXPECT_GT(once, 0.0f);
  rig.rest(0.1);
  EXPECT_NEAR(yaw_of(rig.q()), once, 1e-5f);
}

TEST(EstimatorExternalAttitude, IsNormalisedAndNonsenseIsRefused) {
  // Weak point 22.
  Estimator::Config config;
  config.init_time = Time{0};
  Rig unit(2500, config);
  Rig scaled(2500, config);
  const auto q = Attitude::from_euler(0.1, -0.1, 0.3).floats();
  unit.rest(0.2);
  scaled.rest(0.2);
  ASSERT_TRUE(unit.estimator.set_external_attitude(q));
  ASSERT_TRUE(scaled.estimator.set_external_attitude({-7 * q[0], -7 * q[1], -7 * q[2], -7 * q[3]}));
  unit.sample(kLevel, {});
  scaled.sample(kLevel, {});
  EXPECT_NEAR(unit.q().z, scaled.q().z, 1e-6f);

  const Quaternion before = unit.q();
  for (const std::array<float, 4>& bad : {std::array<float, 4>{0, 0, 0, 0},
                                          {kNan, 0, 0, 0},
                                          {1, 0, kNan, 0},
                                          {1e30f, 1e30f, 0, 0},
                                          {std::numeric_limits<float>::infinity(), 0, 0, 0}}) {
    EXPECT_FALSE(unit.estimator.set_external_attitude(bad));
  }
  unit.rest(0.1);
  EXPECT_NEAR(unit.q().z, before.z, 1e-3f);
}

TEST(EstimatorExternalAttitude, WithoutTimeItDoesNothing) {
  Rig rig(2500);
  rig.rest(0.5);
  ASSERT_TRUE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, 0.3).floats()));
  rig.after(0, kLevel, {});
  EXPECT_TRUE(std::isfinite(squared_norm(rig.q())));
  EXPECT_NEAR(yaw_of(rig.q()), 0.0f, 1e-6f);
}

// ---- external attitudes far from the estimate

TEST(EstimatorExternalAttitude, FarFromTheEstimateIsRejectedUntilTenAgree) {
  for (const Attitude& far :
       {Attitude::from_euler(0, 0, 30 * kDegree), Attitude::from_euler(25 * kDegree, 0, 0),
        Attitude::from_euler(0, 0, 179.9 * kDegree)}) {
    Rig rig(2500, unboosted());
    rig.rest(1.0);
    for (int k = 1; k <= 30; ++k) {
      ASSERT_EQ(rig.estimator.set_external_attitude(far.floats()), k >= 10) << k;
      rig.rest(0.05, far.accel_at_rest());
    }
    EXPECT_EQ(rig.estimator.external_rejected(), 9u);
    EXPECT_LT(far.angle_to(rig.q()), 25 * kDegree);
    for (int k = 0; k < 100; ++k) {
      ASSERT_TRUE(rig.estimator.set_external_attitude(far.floats()));
      rig.rest(0.05, far.accel_at_rest());
    }
    EXPECT_LT(far.angle_to(rig.q()), 1 * kDegree);
  }
}

TEST(EstimatorExternalAttitude, TwentyDegreesAreTaken) {
  for (const auto& [yaw_deg, taken] : {std::pair{19.5, true}, {20.5, false}, {-19.5, true}}) {
    Rig rig(2500, unboosted());
    rig.rest(1.0);
    EXPECT_EQ(
        rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, yaw_deg * kDegree).floats()),
        taken);
  }
}

TEST(EstimatorExternalAttitude, OutliersNeitherTurnTheEstimateNorStopGoodOnes) {
  Rig rig(2500, unboosted());
  rig.rest(1.0);
  const Attitude good = Attitude::from_euler(0, 0, 0.1);
  for (int k = 0; k < 400; ++k) {
    const bool outlier = k % 4 == 3;
    const double wrong = (40.0 + 37.0 * (k % 7)) * kDegree;
    const auto q = outlier ? Attitude::from_euler(0.5, wrong / 9, wrong).floats() : good.floats();
    ASSERT_EQ(rig.estimator.set_external_attitude(q), !outlier) << k;
    rig.rest(0.02);
    ASSERT_LT(std::abs(yaw_of(rig.q())), 0.1005f);
  }
  EXPECT_NEAR(yaw_of(rig.q()), 0.1f, 0.01f);
}

TEST(EstimatorExternalAttitude, OnesThatDisagreeWithOneAnotherAreNeverTaken) {
  Rig rig(2500, unboosted());
  rig.rest(1.0);
  for (int k = 0; k < 200; ++k) {  // turns 6 degrees a message, which the gyro denies
    const double yaw = (30.0 + 6.0 * (k % 50)) * kDegree;
    ASSERT_FALSE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, yaw).floats()));
    rig.rest(0.02);
  }
  // 0.6 degrees a message: nine agree with the first of their run, the tenth does not.
  for (int k = 0; k < 200; ++k) {
    const double yaw = (60.0 + 0.6 * k) * kDegree;
    ASSERT_FALSE(rig.estimator.set_external_attitude(Attitude::from_euler(0, 0, yaw).floats()));
    rig.rest(0.02);
  }
  EXPECT_NEAR(yaw_of(rig.q()), 0.0f, 1e-3f);
  // NaN in between is no agreement either.
  for (int k = 0; k < 100; ++k) {
    const auto far = Attitude::from_euler(0, 0, 1.0).floats();
    ASSERT_FALSE(rig.estimator.set_external_attitude(
        k % 9 == 8 ? std::array<float, 4>{kNan, 0, 0, 0} : far));
    rig.rest(0.02);
  }
}

TEST(EstimatorExternalAttitude, AHeadingIsTakenOverWhileTheVehicleTurns) {
  // 1 rad/s of yaw, attitudes at 10 Hz: 5.7 degrees apart, but agreeing with the gyro.
  Rig rig(2500, unboosted());
  rig.rest(1.0);
  Attitude truth_q = Attitude::from_euler(0, 0, 2.0);
  for (int k = 0; k < 4000; ++k) {
    truth_q = truth_q.turned({0, 0, 1}, 0.0025);
    rig.sample(truth_q.accel_at_rest(), {0.0f, 0.0f, 1.0f});
    if (k % 40 == 0) {
      EXPECT_EQ(rig.estimator.set_external_attitude(truth_q.floats()), k >= 360) << k;
    }
  }
  EXPECT_LT(truth_q.angle_to(rig.q()), 3 * kDegree);
}

// ---- gaps

TEST(EstimatorGap, IsIntegratedWithTheMeanOfBothEnds) {
  // Weak point 24: one sample stood for the whole gap. From 0 to 2 rad/s in half a second is
  // 0.5 rad.
  Rig rig(2500);
  rig.rest(5.0);
  const AttitudeEstimate& e = rig.after(500'000, kLevel, {2.0f, 0.0f, 0.0f});
  EXPECT_NEAR(e.roll_rad, 0.5f, 1e-5f);
  EXPECT_NEAR(e.rates_rad_s.x(), 2.0f, 1e-5f);  // the low-pass restarts
}

TEST(EstimatorGap, KeepsTheAttitudeOfASteadyTurn) {
  for (const bool exact : {true, false}) {
    for (const std::int64_t gap_us : {20'000, 30'000, 120'000, 500'000, 1'000'000}) {
      Estimator::Config config;
      config.exact_step = exact;
      Rig rig(2500, config);
      Attitude truth_q;
      const Rates w{0.0, 0.6, 0.8};  // 1 rad/s
      const hal::Vec3 gyro{0.0f, 0.6f, 0.8f};
      rig.rest(4.0);
      for (int k = 0; k < 200; ++k) {
        truth_q = truth_q.turned(w, 0.0025);
        rig.sample(truth_q.accel_at_rest(), gyro);
      }
      const double before = truth_q.angle_to(rig.q());
      truth_q = truth_q.turned(w, static_cast<double>(gap_us) * 1e-6);
      rig.after(gap_us, truth_q.accel_at_rest(), gyro);
      EXPECT_LT(truth_q.angle_to(rig.q()), before + 0.1 * kDegree) << gap_us;
    }
  }
}

TEST(EstimatorGap, GivesTheAccelerometerNoMoreWeight) {
  // A vehicle that turns hard shows an accelerometer 30 degrees off, within the margin.
  // 1 s of it costs 13 degrees at 0.5/s; ten times the gain would cost all 30.
  Rig rig(2500);
  rig.rest(5.0);
  rig.after(150'000, Attitude::from_euler(30 * kDegree, 0, 0).accel_at_rest(), {});
  EXPECT_LT(std::abs(rig.estimator.estimate().roll_rad), 0.1 * kDegree);
  rig.rest(1.0, Attitude::from_euler(30 * kDegree, 0, 0).accel_at_rest());
  EXPECT_LT(std::abs(rig.estimator.estimate().roll_rad), 13 * kDegree);
  EXPECT_TRUE(rig.estimator.healthy());
}

TEST(EstimatorGap, DoesNotCountAsTimeWithoutAccelerometer) {
  Rig rig(2500);
  rig.rest(1.0);
  rig.after(900'000, {0.0f, 0.0f, -30.0f}, {});
  rig.rest(0.3, {0.0f, 0.0f, -30.0f});
  EXPECT_TRUE(rig.estimator.healthy());
  rig.rest(0.3, {0.0f, 0.0f, -30.0f});
  EXPECT_FALSE(rig.estimator.healthy());
}

TEST(EstimatorGap, AboveOneSecondStartsAgainFromTheAccelerometerAndKeepsYaw) {
  Rig rig(2500);
  rig.rest(1.0);
  rig.rest(1.0, kLevel, {0.0f, 0.0f, 0.5f});
  const float yaw = yaw_of(rig.q());
  ASSERT_GT(yaw, 0.4f);
  const Attitude fallen = Attitude::from_euler(-0.6, 0.3, 0);
  const AttitudeEstimate& e = rig.after(1'001'000, fallen.accel_at_rest(), {});
  EXPECT_NEAR(e.roll_rad, -0.6f, 1e-4f);
  EXPECT_NEAR(e.pitch_rad, 0.3f, 1e-4f);
  EXPECT_NEAR(yaw_of(e.q_WB), yaw, 1e-4f);
  // The start may have been accelerated: the boost follows.
  rig.rest(0.5);
  EXPECT_LT(tilt_error_deg(rig.q(), Attitude{}), 5.0);
}

TEST(EstimatorStart, AnyFirstStampIsHarmless) {
  for (const std::int64_t first_us : {std::numeric_limits<std::int64_t>::min(),
                                      std::numeric_limits<std::int64_t>::max(), std::int64_t{-1}}) {
    Rig rig(2500);
    rig.estimator.step({Time{first_us}, kLevel, {}, 298.15f}, 0.0f);
    rig.rest(2.0);
    ASSERT_TRUE(rig.estimator.set_external_attitude({1, 0, 0, 0}));
    rig.rest(2.0, Attitude::from_euler(0.1, 0, 0).accel_at_rest());
    EXPECT_TRUE(rig.estimator.healthy());
    EXPECT_GT(rig.estimator.estimate().roll_rad, 0.02f);
  }
}

TEST(EstimatorGap, OfAnyLengthIsHarmless) {
  for (const double seconds : {1.5, 1e3, 1e9, 1e12}) {
    Rig rig(2500);
    rig.rest(1.0);
    rig.estimator.step({hal::microseconds(rig.now_us), kLevel, {1.0f, 1.0f, 1.0f}, 298.15f},
                       static_cast<float>(seconds));
    rig.rest(1.0);
    EXPECT_NEAR(squared_norm(rig.q()), 1.0f, 1e-6f);
    EXPECT_LT(tilt_error_deg(rig.q(), Attitude{}), 1.0);
    EXPECT_TRUE(rig.estimator.healthy());
  }
}

TEST(EstimatorGap, StampsThatStartAnewDoNotBringTheBoostBack) {
  Rig rig(2500);
  rig.rest(100.0);
  rig.now_us = 0;  // the IMU's clock was reset; dt stays what it was
  rig.rest(0.5, Attitude::from_euler(20 * kDegree, 0, 0).accel_at_rest());
  EXPECT_LT(rig.estimator.estimate().roll_rad, 6 * kDegree);
  EXPECT_TRUE(rig.estimator.healthy());
  rig.now_us = std::int64_t{1} << 60;
  rig.rest(0.5);
  EXPECT_TRUE(rig.estimator.healthy());
}

}  // namespace
}  // namespace rosflight::core
