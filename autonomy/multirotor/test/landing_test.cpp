// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/landing.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::autonomy::multirotor {
namespace {

constexpr double kDt = 0.01;
constexpr double kHover = 34.3;

Landing started() {
  Landing landing{LandingConfig{}};
  landing.start();
  return landing;
}

Landing::Output run(Landing& landing, double seconds, Landing::Input in) {
  in.dt_s = kDt;
  in.hover_thrust_N = kHover;
  Landing::Output out;
  for (long k = std::lround(seconds / kDt); k > 0; --k) out = landing.step(in);
  return out;
}

TEST(Landing, SlowsDownNearTheHeightOfTheStart) {
  Landing landing = started();
  const auto speed = [&](double height_m) {
    return run(landing, 2.0, {.down_speed_m_s = 1.0, .height_m = height_m, .thrust_N = kHover})
        .down_speed_m_s;
  };
  EXPECT_NEAR(speed(20.0), 1.0, 1e-12);
  EXPECT_NEAR(speed(1.5), 1.0, 1e-12);
  EXPECT_NEAR(speed(0.75), 0.675, 1e-12);
  EXPECT_NEAR(speed(0.0), 0.35, 1e-12);
  EXPECT_NEAR(speed(-10.0), 0.35, 1e-12);  // lower ground: on, slowly
}

TEST(Landing, DescentBuildsUpSmoothly) {
  Landing landing = started();
  EXPECT_NEAR(run(landing, 0.5, {.height_m = 20.0, .thrust_N = kHover}).down_speed_m_s, 0.5, 1e-9);
}

TEST(Landing, StandingIsProbedAndConfirmed) {
  Landing landing = started();
  Landing::Input standing{.down_speed_m_s = 0.0, .height_m = 0.0, .thrust_N = 0.85 * kHover};
  EXPECT_FALSE(run(landing, 1.35, standing).unloading);  // 1 s to settle, 0.4 s of standing
  EXPECT_TRUE(run(landing, 0.1, standing).unloading);
  Landing::Output out;
  double seconds = 0.0;
  while (!out.touched && seconds < 5.0) {
    out = run(landing, kDt, standing);
    seconds += kDt;
  }
  // 0.85 to 0.2 of hover at 1 a second, then 0.3 s of rest
  EXPECT_NEAR(seconds, 0.65 + 0.3, 0.08);
  EXPECT_LE(out.thrust_N, 0.2 * kHover);
}

TEST(Landing, HoveringIsNotStanding) {
  Landing landing = started();
  EXPECT_FALSE(
      run(landing, 20.0, {.down_speed_m_s = 0.0, .height_m = 0.5, .thrust_N = kHover}).unloading);
}

TEST(Landing, DescendingIsNotStanding) {
  Landing landing = started();
  EXPECT_FALSE(
      run(landing, 20.0, {.down_speed_m_s = 0.3, .height_m = 0.0, .thrust_N = 0.9 * kHover})
          .unloading);
}

TEST(Landing, TheRangeSensorShowsTheGroundWhateverTheSpeedIsEstimated) {
  for (const double down_speed_m_s : {0.6, -0.6}) {
    Landing landing = started();
    const Landing::Input standing{.down_speed_m_s = down_speed_m_s,
                                  .height_m = 1.0,
                                  .thrust_N = 1.1 * kHover,
                                  .at_ground = true};
    EXPECT_FALSE(run(landing, 1.35, standing).unloading);
    EXPECT_TRUE(run(landing, 0.1, standing).unloading);
    EXPECT_TRUE(run(landing, 1.3, standing).touched) << down_speed_m_s;
  }
}

TEST(Landing, FallingWhileProbedGoesOnDescending) {
  Landing landing = started();
  ASSERT_TRUE(run(landing, 1.6, {.height_m = 3.0, .thrust_N = 0.9 * kHover}).unloading);
  const auto out =
      run(landing, kDt, {.down_speed_m_s = 0.5, .height_m = 3.0, .thrust_N = 0.6 * kHover});
  EXPECT_FALSE(out.unloading);
  EXPECT_FALSE(out.touched);
  EXPECT_NEAR(out.down_speed_m_s, 1.0, 1e-9);
}

TEST(Landing, StartForgetsTheLastOne) {
  Landing landing = started();
  const Landing::Input standing{.thrust_N = 0.8 * kHover};
  ASSERT_TRUE(run(landing, 4.0, standing).touched);
  landing.start();
  EXPECT_FALSE(run(landing, 0.5, standing).unloading);
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
