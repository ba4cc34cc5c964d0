// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/glide.hpp"

#include <gtest/gtest.h>

#include <random>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr GlideConfig kGlide{};
const Vector2 kCalm = Vector2::Zero();

TEST(Glide, StraightOnInStillAirTheHeightIsTheDistanceOverTheRatio) {
  const GlidePlanner planner(kGlide);
  const Pose from{{0.0, 0.0}, 0.0};
  const Pose key{{300.0, 0.0}, 0.0};
  EXPECT_NEAR(planner.height_needed_m(from, key, 100.0, kCalm),
              (400.0 - kGlide.flare_m) / kGlide.ratio, 1e-9);
}

TEST(Glide, WindChangesTheDistanceByItsShareOfTheAirspeed) {
  const GlidePlanner planner(kGlide);
  // 7 m/s against 14: half the way; with it: half as much again.
  EXPECT_NEAR(planner.distance_per_height(0.0, {-7.0, 0.0}), 0.5 * kGlide.ratio, 1e-9);
  EXPECT_NEAR(planner.distance_per_height(0.0, {7.0, 0.0}), 1.5 * kGlide.ratio, 1e-9);
  // From the side: the share that is left of the airspeed.
  EXPECT_NEAR(planner.distance_per_height(0.0, {0.0, 7.0}), std::sqrt(0.75) * kGlide.ratio, 1e-9);
}

TEST(Glide, AWholeTurnCostsItsLengthAndItsLoad) {
  const GlidePlanner planner(kGlide);
  const double bank = std::atan(14.0 * 14.0 / (9.80665 * 50.0));
  EXPECT_NEAR(planner.turn_height_m(), 2.0 * kPi * 50.0 / 8.5 * std::pow(1.0 / std::cos(bank), 1.5),
              1e-9);
  const Pose from{{0.0, 0.0}, 0.0};
  const Pose opposite{{0.0, 100.0}, kPi};  // half a turn to the right
  EXPECT_NEAR(planner.height_needed_m(from, opposite, 15.0, kCalm), 0.5 * planner.turn_height_m(),
              1e-6);
}

/// The bank of a turn over ground is that of its speed over ground: Vg = 21 m/s down the wind needs
/// tan(bank) = 21^2/(9.80665 x 50), against the wind 7^2/(9.80665 x 50).
TEST(Glide, InATurnDownTheWindTheLoadIsThatOfTheSpeedOverGround) {
  const GlidePlanner planner(kGlide);
  const Vector2 north(7.0, 0.0);
  constexpr double kArc_rad = 0.02;
  const auto needed = [&](double course_rad) {
    const double mean_rad = course_rad + 0.5 * kArc_rad;
    const Pose from{{0.0, 0.0}, course_rad};
    const Pose key{2.0 * 50.0 * std::sin(0.5 * kArc_rad) * along(mean_rad), course_rad + kArc_rad};
    return planner.height_needed_m(from, key, 0.0, north);
  };
  const auto expected = [](double over_ground_m_s) {
    const double tan_bank = over_ground_m_s * over_ground_m_s / (9.80665 * 50.0);
    const double load = std::sqrt(1.0 + tan_bank * tan_bank);
    return 50.0 * kArc_rad / (8.5 * over_ground_m_s / 14.0) * std::pow(load, 1.5);
  };
  EXPECT_NEAR(needed(-0.5 * kArc_rad), expected(21.0), 1e-3 * expected(21.0));
  EXPECT_NEAR(needed(kPi - 0.5 * kArc_rad), expected(7.0), 1e-3 * expected(7.0));
}

TEST(Glide, TheHeightIsUsedUpAtTheFieldFromWhereverItIsWithinReach) {
  const GlidePlanner planner(kGlide);
  const Field field{{0.0, 0.0, 0.0}, 0.0};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-250.0, 250.0);
  std::uniform_real_distribution<double> course(-kPi, kPi);
  int found = 0;
  for (int k = 0; k < 300; ++k) {
    const Pose from{{place(random), place(random)}, course(random)};
    const double height_m = 90.0;
    const auto path = planner.plan(from, height_m, field, kCalm);
    if (!path) continue;  // more than a turn too high
    ++found;
    EXPECT_GE(path->spare_m, 0.0);
    EXPECT_LE(path->spare_m, planner.turn_height_m());
    EXPECT_NEAR(planner.height_needed_m(from, path->key, path->final_m, kCalm),
                path->height_needed_m, 1e-9);
    const Vector2 end = path->key.p_m + path->final_m * along(path->key.course_rad);
    EXPECT_NEAR(end.norm(), 0.0, 1e-6);
  }
  EXPECT_GT(found, 200);
}

TEST(Glide, OutOfReachThereIsNoPath) {
  const GlidePlanner planner(kGlide);
  const Pose from{{-1000.0, 0.0}, 0.0};
  const Field field{{0.0, 0.0, 0.0}, 0.0};
  EXPECT_TRUE(planner.out_of_reach(from, 100.0, field, kCalm));
  EXPECT_FALSE(planner.plan(from, 100.0, field, kCalm).has_value());
  EXPECT_FALSE(planner.out_of_reach(from, 130.0, field, kCalm));
  EXPECT_TRUE(planner.plan(from, 130.0, field, kCalm).has_value());
  // With the wind it is.
  EXPECT_FALSE(planner.out_of_reach(from, 100.0, field, {5.0, 0.0}));
}

}  // namespace
}  // namespace rosflight::autonomy::fixedwing
