// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/controller.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "autonomy/fixedwing/test/small_world.hpp"

namespace rosflight::autonomy::fixedwing::test {
namespace {

struct Bench {
  explicit Bench(LongitudinalKind kind = LongitudinalKind::kTotalEnergy) {
    config = default_config().controller;
    config.longitudinal = kind;
    controller = std::make_unique<Controller>(config);
    plant.fly_from({0.0, 0.0, -100.0}, 0.0, 15.0);
    command.valid = true;
    command.airspeed_m_s = 15.0;
    command.height_m = 100.0;
  }
  void run(double seconds, const std::function<void()>& after = [] {}) {
    for (long k = 0; k < std::lround(seconds / 0.01); ++k) {
      out = controller->step({plant.state(), command, age_s, 0.01, pilot, direct});
      Surfaces reached = out.surfaces;
      reached.aileron = stuck_aileron.value_or(reached.aileron);
      for (int i = 0; i < 4; ++i) plant.step(reached, 0.0025);
      after();
    }
  }
  double roll() const { return RollPitch::of(plant.state().q_WB).roll_rad; }
  double height() const { return -plant.state().p_W.z(); }
  double speed() const { return plant.state().airspeed_m_s; }

  ControllerConfig config;
  std::unique_ptr<Controller> controller;
  Plant plant;
  ControllerCommand command{};
  double age_s{};
  PilotOverride pilot{};
  Controller::Direct direct{};
  std::optional<double> stuck_aileron;
  Controller::Output out{};
};

class BothLaws : public testing::TestWithParam<LongitudinalKind> {};

TEST_P(BothLaws, HoldsCourseHeightAndAirspeed) {
  Bench bench(GetParam());
  bench.command.course_rad = 1.0;
  bench.command.height_m = 110.0;
  bench.command.airspeed_m_s = 17.0;
  bench.run(60.0);
  EXPECT_NEAR(wrap_angle(bench.plant.state().course_rad - 1.0), 0.0, 0.01);
  EXPECT_NEAR(bench.height(), 110.0, 0.3);
  EXPECT_NEAR(bench.speed(), 17.0, 0.1);
}

TEST_P(BothLaws, FollowsARamp) {
  Bench bench(GetParam());
  double worst_m = 0.0;
  double worst_m_s = 0.0;
  bench.command.climb_ff_m_s = 1.5;
  for (int k = 0; k < 6000; ++k) {
    bench.command.height_m += 0.015;
    bench.run(0.01);
    if (k < 1500) continue;
    worst_m = std::max(worst_m, std::abs(bench.command.height_m - bench.height()));
    worst_m_s = std::max(worst_m_s, std::abs(15.0 - bench.speed()));
  }
  EXPECT_LT(worst_m, 0.5);
  EXPECT_LT(worst_m_s, 0.5);
}

/// Points 31, 32: throttle stays in its limits and may close; pitch has limits of its own.
TEST_P(BothLaws, ThrottleAndPitchStayInTheirOwnLimits) {
  Bench bench(GetParam());
  bench.config.max_throttle = 0.8;
  bench.controller->configure(bench.config);
  double least = 1.0;
  for (const double height : {400.0, -200.0, 100.0}) {
    bench.command.height_m = height;
    bench.run(10.0, [&] {
      EXPECT_GE(bench.out.surfaces.throttle, 0.0);
      EXPECT_LE(bench.out.surfaces.throttle, 0.8);
      EXPECT_LE(std::abs(bench.out.pitch_c_rad), bench.config.max_pitch_rad + 1e-12);
      least = std::min(least, bench.out.surfaces.throttle);
    });
  }
  EXPECT_LT(least, 0.05);
}

/// Point 32: no division by a commanded airspeed of nothing.
TEST_P(BothLaws, AirspeedZeroIsNoCommand) {
  Bench bench(GetParam());
  bench.command.airspeed_m_s = 0.0;
  bench.run(1.0);
  EXPECT_TRUE(bench.out.lost);
  EXPECT_TRUE(std::isfinite(bench.out.surfaces.throttle + bench.out.surfaces.elevator));
}

INSTANTIATE_TEST_SUITE_P(Laws, BothLaws,
                         testing::Values(LongitudinalKind::kTotalEnergy,
                                         LongitudinalKind::kSuccessiveLoops));

/// With kinetic and potential error of opposite sign the energy is right and only pitch acts.
TEST(TotalEnergy, SharesWithoutThrottleWhatIsOnlyInTheWrongPlace) {
  TotalEnergy law(TotalEnergyConfig{.gravity_m_s2 = 10.0});
  LongitudinalLaw::Input in;
  in.dt_s = 1e-6;
  in.height_m = 100.0;
  in.airspeed_m_s = 16.0;
  in.airspeed_c_m_s = 15.0;
  in.height_c_m = 100.0 + 0.5 * (16.0 * 16.0 - 15.0 * 15.0) / 10.0;
  in.throttle_ff = 0.5;
  in.min_climb_rad = -0.5;
  in.max_climb_rad = 0.5;
  const auto out = law.step(in);
  EXPECT_NEAR(out.throttle, 0.5, 1e-5);
  EXPECT_GT(out.climb_angle_rad, 0.05);
  // E and L of the law by hand: U = 15.5, K = -15.5, K_ref = 112.5.
  EXPECT_NEAR(out.climb_angle_rad, TotalEnergyConfig{}.balance.kp * 31.0 / 112.5, 1e-5);
}

/// Low on an approach a missing airspeed is the throttle's: the nose stays on the path.
TEST(TotalEnergy, WithoutAShareOfTheSpeedPitchHoldsTheHeightAlone) {
  LongitudinalLaw::Input in;
  in.dt_s = 1e-6;
  in.airspeed_m_s = 12.0;
  in.airspeed_c_m_s = 15.0;
  in.max_climb_rad = 0.5;
  in.min_climb_rad = -0.5;
  const auto shared = TotalEnergy(TotalEnergyConfig{}).step(in);
  in.speed_share = 0.0;
  const auto alone = TotalEnergy(TotalEnergyConfig{}).step(in);
  EXPECT_LT(shared.climb_angle_rad, -0.1);
  EXPECT_NEAR(alone.climb_angle_rad, 0.0, 1e-6);
  EXPECT_EQ(alone.throttle, shared.throttle);
}

/// Point 40: a command that stops is not flown on for ever.
TEST(FixedWingController, CirclesWhenItsCommandStops) {
  Bench bench;
  bench.run(5.0);
  bench.age_s = bench.config.command_timeout_s + 0.01;
  bench.run(30.0);
  EXPECT_TRUE(bench.out.lost);
  EXPECT_NEAR(bench.roll(), bench.config.lost_roll_rad, 0.03);
  EXPECT_NEAR(bench.height(), 100.0, 1.0);
  EXPECT_NEAR(bench.speed(), bench.config.cruise_m_s, 0.3);
  bench.age_s = 0.0;
  bench.run(30.0);
  EXPECT_FALSE(bench.out.lost);
  EXPECT_NEAR(bench.plant.state().course_rad, 0.0, 0.02);
}

/// Point 30: the washout lets a steady turn pass and stops a swing, and has its pole where it
/// belongs: after a step of the yaw rate the rudder dies out with e^(-w t).
TEST(FixedWingController, YawDamperIsAWashout) {
  Bench bench;
  StateEstimate s = bench.plant.state();
  static_cast<void>(bench.controller->step({s, bench.command, 0.0, 0.01, {}, {}}));
  s.w_B.z() = 1.0;
  const double first =
      bench.controller->step({s, bench.command, 0.0, 0.01, {}, {}}).surfaces.rudder;
  EXPECT_NEAR(first, -bench.config.yaw_damper_s, 0.01 * bench.config.yaw_damper_s);
  double rudder = first;
  for (int k = 0; k < 100; ++k) {
    rudder = bench.controller->step({s, bench.command, 0.0, 0.01, {}, {}}).surfaces.rudder;
  }
  EXPECT_NEAR(rudder / first, std::exp(-bench.config.yaw_washout_rad_s * 1.0), 0.005);
}

TEST(FixedWingController, SpeedGuardGivesHeightForSpeed) {
  Bench bench;
  bench.run(5.0);
  bench.plant.config().motor = 0.0;
  double slowest = 99.0;
  bench.run(40.0, [&] { slowest = std::min(slowest, bench.speed()); });
  EXPECT_GT(slowest, bench.config.min_airspeed_m_s - 1.5);
  EXPECT_LT(bench.height(), 90.0);
}

/// Sinking fast with the nose up is a stall, however fast: the nose must come down.
TEST(FixedWingController, StallGuardFollowsThePathOfTheAir) {
  Bench bench;
  StateEstimate s = bench.plant.state();
  s.v_W.z() = 5.0;
  s.airspeed_m_s = 20.0;
  bench.command.height_m = 120.0;
  const auto& out = bench.controller->step({s, bench.command, 0.0, 0.01, {}, {}});
  EXPECT_NEAR(out.pitch_c_rad, std::asin(-0.25) + bench.config.max_alpha_rad, 1e-9);
}

/// Points 33, 39: repeated times and the first step change nothing that was not set.
TEST(FixedWingController, RepeatedTimeRepeatsTheOutput) {
  Bench bench;
  bench.run(2.0);
  const Surfaces before = bench.out.surfaces;
  const auto& same = bench.controller->step({bench.plant.state(), bench.command, 0.0, 0.0, {}, {}});
  EXPECT_EQ(same.surfaces.elevator, before.elevator);
  Controller one(bench.config);
  Controller two(bench.config);
  const Controller::Input in{bench.plant.state(), bench.command, 0.0, 0.01, {}, {}};
  EXPECT_EQ(one.step(in).surfaces.throttle, two.step(in).surfaces.throttle);
}

TEST(FixedWingController, ALawOfOnesOwnFlies) {
  struct Glide final : LongitudinalLaw {
    Output step(const Input&) override { return {-0.1, 0.25}; }
    void reset() override {}
  };
  Bench bench;
  bench.controller = std::make_unique<Controller>(bench.config, std::make_unique<Glide>());
  bench.run(10.0);
  EXPECT_EQ(bench.out.surfaces.throttle, 0.25);
  EXPECT_LT(bench.height(), 97.0);
}

TEST(FixedWingController, SurfacesAreByEffectAndLimited) {
  Bench bench;
  bench.direct.roll_rad = 40.0 * kRadPerDeg;
  bench.run(0.05);
  EXPECT_GT(bench.out.surfaces.aileron, 0.0);
  bench.run(12.0, [&] {
    for (const double s :
         {bench.out.surfaces.aileron, bench.out.surfaces.elevator, bench.out.surfaces.rudder}) {
      EXPECT_LE(std::abs(s), 1.0);
    }
  });
  EXPECT_NEAR(bench.roll(), 40.0 * kRadPerDeg, 0.03);
}

/// Sideslip of the full rudder, C_n_dr/C_n_beta = 0.53, rolls by 0.13 * 0.53 = 0.069 against 0.17 of
/// the ailerons: up to 0.4 of their travel, the rest is for control.
TEST(FixedWingController, WithoutAileronsTheRudderHoldsTheCourse) {
  struct Stuck {
    double at, steepest_deg;
  };
  // The last one carries on into the turn, and only beyond the wanted bank it shows.
  for (const auto& [stuck, steepest_deg] :
       {Stuck{-0.1, 45.0}, Stuck{0.0, 45.0}, Stuck{0.05, 45.0}, Stuck{0.15, 80.0}}) {
    Bench bench;
    bench.run(5.0);
    bench.stuck_aileron = stuck;
    bench.command.course_rad = 2.0;
    double steepest = 0.0;
    bench.run(60.0, [&] { steepest = std::max(steepest, std::abs(bench.roll())); });
    EXPECT_TRUE(bench.out.aileron_lost) << stuck;
    EXPECT_LT(steepest, steepest_deg * kRadPerDeg) << stuck;
    EXPECT_NEAR(wrap_angle(bench.plant.state().course_rad - 2.0), 0.0, 0.05) << stuck;
    EXPECT_NEAR(bench.height(), 100.0, 2.0) << stuck;
  }
}

TEST(FixedWingController, AileronsThatWorkAreNeverLost) {
  Bench bench;
  for (const double course_rad : {1.5, -1.5, 3.0, 0.0}) {
    bench.command.course_rad = course_rad;
    bench.run(20.0, [&] { ASSERT_FALSE(bench.out.aileron_lost); });
  }
}

/// Each condition alone is not enough: command, error, no rate, time.
TEST(AileronWatch, NeedsACommandWithoutEffectForSomeTime) {
  constexpr double kFull_rad_s = 3.6;
  const auto lost = [](double aileron, double error_rad, double rate_rad_s, double for_s) {
    AileronWatch watch;
    for (double t = 0.0; t < for_s; t += 0.01) {
      watch.step(aileron, error_rad, rate_rad_s, kFull_rad_s, 0.01);
    }
    return watch.lost();
  };
  EXPECT_TRUE(lost(0.5, 0.3, 0.0, 1.0));
  EXPECT_TRUE(lost(0.5, 0.3, 0.17, 1.0));   // a tenth would be 0.18
  EXPECT_TRUE(lost(-0.5, -0.3, 0.5, 1.0));  // it rolls away
  EXPECT_FALSE(lost(0.1, 0.3, 0.0, 1.0));
  EXPECT_FALSE(lost(0.5, 0.05, 0.0, 1.0));
  EXPECT_FALSE(lost(0.5, 0.3, 0.2, 1.0));
  EXPECT_FALSE(lost(0.5, 0.3, 0.0, 0.35));
  AileronWatch watch;
  for (int k = 0; k < 300; ++k) {
    watch.step(0.5, 0.3, k % 30 == 0 ? 0.4 : 0.0, kFull_rad_s, 0.01);
    AileronWatch unknown;
    EXPECT_FALSE(unknown.step(0.5, 0.3, 0.0, 0.0, 100.0));
  }
  EXPECT_FALSE(watch.lost());
}

/// A change of inner gains in flight leaves the trim of the outer ones alone.
TEST(FixedWingController, AChangeOfRollGainsKeepsTheThrottle) {
  Bench bench;
  bench.command.airspeed_m_s = 17.0;
  bench.run(60.0);
  const double before = bench.out.surfaces.throttle;
  ControllerConfig changed = bench.config;
  changed.roll.kp *= 1.2;
  bench.controller->configure(changed);
  bench.run(0.02);
  EXPECT_NEAR(bench.out.surfaces.throttle, before, 0.01);
  changed.total_energy.energy.kp *= 1.2;
  bench.controller->configure(changed);
  bench.run(0.02);
  EXPECT_GT(std::abs(bench.out.surfaces.throttle - before), 0.01);  // its integral is forgotten
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing::test
