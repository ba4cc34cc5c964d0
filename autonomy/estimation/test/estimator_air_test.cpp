// SPDX-License-Identifier: BSD-3-Clause
// The estimator of a fixed wing and the air: wind, gusts, force of the air, a blocked pitot tube.
#include <gtest/gtest.h>

#include <type_traits>

#include "autonomy/estimation/estimator.hpp"
#include "autonomy/estimation/test/world.hpp"

namespace rosflight::autonomy::estimation::test {
namespace {

/// A fixed wing in steady wind; the wind of the filter walks by little.
struct WindyFixedWing {
  static constexpr double kPhase = 0.5;

  static WorldConfig configured() {
    WorldConfig config;
    config.filter.declination_rad = field_declination();
    config.filter.gnss_horizontal_sigma_m = 0.3;
    config.filter.noise.wind_m_s_rts = 0.02;
    config.filter.sideslip_sigma_m_s = 0.5;
    config.filter.use_sideslip = false;
    config.fixedwing = true;
    config.range = false;
    config.accel_bias_sigma = 0.03;
    config.wind_W = {5.0, -3.0, 0.0};
    return config;
  }
  void run_until(double t_s) {
    while (world.time_s() < t_s) {
      if (!estimator.initialised()) {
        estimator.set_attitude_hint(world.time_s(), world.motion(world.time_s()).q_WB);
      }
      world.step(estimator);
    }
  }
  /// Error of the airspeed against the air without the gust [m/s].
  double airspeed_error_m_s() const {
    const StateEstimate e = estimator.estimate();
    return e.airspeed_m_s - (world.motion(e.t_s).v_W - config.wind_W).norm();
  }

  WorldConfig config{configured()};
  World world{config, [this](double t) { return fixedwing_at(t, kPhase, config.wind_W); }};
  Estimator estimator{config.filter, Airframe::kFixedWing};
};

TEST(Estimator, FindsTheWindWithPitotAndSideslip) {
  WindyFixedWing f;
  f.run_until(40.0);
  const StateEstimate e = f.estimator.estimate();
  EXPECT_TRUE(e.wind_valid);
  EXPECT_TRUE(e.air_valid);
  EXPECT_LT((e.wind_W - f.config.wind_W).norm(), 0.6);
  const Motion truth = f.world.motion(e.t_s);
  EXPECT_NEAR(f.airspeed_error_m_s(), 0.0, 0.5);
  EXPECT_NEAR(e.beta_rad, 0.0, 0.05);
  EXPECT_NEAR(e.course_rad, std::atan2(truth.v_W.y(), truth.v_W.x()), 0.05);
}

TEST(Estimator, AGustThatShutsThePitotOutIsLetInAgain) {
  for (const double gust_m_s : {-4.0, -2.0, 3.0, 5.0}) {
    WindyFixedWing f;
    f.run_until(40.0);
    f.world.extra_airspeed_m_s = gust_m_s;
    f.run_until(45.0);
    EXPECT_NEAR(f.airspeed_error_m_s(), gust_m_s, 0.7);
    EXPECT_LE(f.estimator.health().wind_relearned, 2U) << gust_m_s;
    EXPECT_GE(f.estimator.health().wind_relearned, 1U) << gust_m_s;
  }
}

/// It stands in the air with its nose into 8 m/s of wind.
struct Hovering {
  static WorldConfig configured(bool hovers) {
    WorldConfig config = WindyFixedWing::configured();
    config.wind_W = {-8.0, 0.0, 0.0};
    config.filter.hovers = hovers;
    config.filter.noise.wind_m_s_rts = 0.1;
    return config;
  }
  static Motion still(double /*t_s*/) {
    Motion motion;
    motion.p_W.z() = -20.0;
    return motion;
  }
  explicit Hovering(bool hovers) : config{configured(hovers)} {
    while (world.time_s() < 20.0) {
      if (!estimator.initialised())
        estimator.set_attitude_hint(world.time_s(), Quaternion::Identity());
      world.step(estimator);
    }
  }
  WorldConfig config;
  World world{config, still};
  Estimator estimator{config.filter, Airframe::kFixedWing};
};

/// The estimate has no airspeed before it has the wind: only the measured one shows that the pitot tube can be fused.
TEST(Estimator, AVehicleThatHoversFindsTheWindWithItsPitot) {
  Hovering f(true);
  EXPECT_NEAR(f.estimator.estimate().wind_W.x(), -8.0, 0.5);
  EXPECT_NEAR(f.estimator.estimate().airspeed_m_s, 8.0, 1.0);
  // The wind turns away while it hovers: less than half of the airspeed is no blocked tube here.
  f.world.extra_airspeed_m_s = -5.0;
  while (f.world.time_s() < 26.0) f.world.step(f.estimator);
  EXPECT_NEAR(f.estimator.estimate().wind_W.x(), -3.0, 3.1)
      << "down to the speed from which on it is fused";
}

TEST(Estimator, AFixedWingDoesNotUseItsPitotBelowItsSmallestAirspeed) {
  const Hovering f(false);
  EXPECT_GT(f.estimator.estimate().wind_W.x(), -4.0);
}

/// Passes on all samples but those of the magnetometer.
struct WithoutMag {
  Estimator& estimator;
  template <class Sample>
  void add(const Sample& sample) {
    if constexpr (!std::is_same_v<Sample, MagSample>) estimator.add(sample);
  }
};

TEST(Estimator, WithoutAMagnetometerTheForceOfTheAirHoldsTheHeading) {
  for (const double step_rad_s : {0.0, 0.1, -0.1}) {
    WindyFixedWing f;
    f.config.filter.air.side_area_m2_kg = 0.113;
    f.estimator = Estimator(f.config.filter, Airframe::kFixedWing);
    f.run_until(40.0);
    f.world.extra_gyro.z() = step_rad_s;
    WithoutMag without{f.estimator};
    while (f.world.time_s() < 70.0) f.world.step(without);
    const StateEstimate e = f.estimator.estimate();
    const Motion truth = f.world.motion(e.t_s);
    EXPECT_LT(e.q_WB.angularDistance(truth.q_WB), 0.25) << step_rad_s;
    EXPECT_LT((e.wind_W - f.config.wind_W).norm(), 3.5) << step_rad_s;
  }
}

TEST(Estimator, TheSideForceOfRudderAndTurningIsNoFaultOfTheGyro) {
  constexpr double kPerTurning_m_s = 0.3;
  constexpr double kSoon_s = 0.01;
  WindyFixedWing f;
  f.config.filter.air.side_area_m2_kg = 0.113;
  f.estimator = Estimator(f.config.filter, Airframe::kFixedWing);
  f.run_until(40.0);
  f.world.gnss_on = false;
  WithoutMag without{f.estimator};
  double worst_rad = 0.0;
  while (f.world.time_s() < 100.0) {
    const double t_s = f.world.time_s();
    const Quaternion turn =
        f.world.motion(t_s).q_WB.conjugate() * f.world.motion(t_s + kSoon_s).q_WB;
    f.world.extra_accel.y() = -kPerTurning_m_s * log_rotation(turn).z() / kSoon_s;
    f.world.step(without);
    const StateEstimate e = f.estimator.estimate();
    worst_rad = std::max(worst_rad, e.q_WB.angularDistance(f.world.motion(e.t_s).q_WB));
  }
  EXPECT_EQ(f.estimator.health().imu_widenings, 0U);
  EXPECT_LT(worst_rad, 0.1);
}

TEST(Estimator, WithoutPitotAndGnssTheAirspeedIsNotKnown) {
  WindyFixedWing f;
  f.run_until(40.0);
  f.world.pitot_blocked = true;
  f.run_until(45.0);
  EXPECT_TRUE(f.estimator.estimate().air_valid) << "by ground speed and wind";
  f.world.gnss_on = false;
  f.run_until(47.0);
  EXPECT_FALSE(f.estimator.estimate().air_valid);
  f.world.gnss_on = true;
  f.run_until(50.0);
  EXPECT_TRUE(f.estimator.estimate().air_valid);
}

TEST(Estimator, ABlockedPitotIsNoGust) {
  WindyFixedWing f;
  f.run_until(40.0);
  f.world.pitot_blocked = true;
  f.run_until(80.0);
  EXPECT_EQ(f.estimator.health().wind_relearned, 0U);
  EXPECT_NEAR(f.airspeed_error_m_s(), 0.0, 1.0);
}

TEST(Estimator, APitotThatReadTooLittleIsNotBelievedUntilItAgrees) {
  WindyFixedWing f;
  f.run_until(40.0);
  f.world.pitot_share = 0.45;
  f.run_until(45.0);
  f.world.pitot_share = 0.6;  // as where the aircraft has become slower
  f.run_until(60.0);
  EXPECT_EQ(f.estimator.health().wind_relearned, 0U);
  EXPECT_NEAR(f.airspeed_error_m_s(), 0.0, 1.0);
  f.world.pitot_share = 1.0;
  f.run_until(65.0);
  EXPECT_GT(f.estimator.health().of(Aid::kPitot).last_accepted_s, 64.5);
  EXPECT_NEAR(f.airspeed_error_m_s(), 0.0, 1.0);
}

}  // namespace
}  // namespace rosflight::autonomy::estimation::test
