// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/ground_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

GroundParameters gear(double damping = 40.0) {
  GroundParameters g;
  g.model = GroundModel::kContact;
  g.contacts_B = {{0.15, 0.15, 0.2}, {-0.15, 0.15, 0.2}, {-0.15, -0.15, 0.2}, {0.15, -0.15, 0.2}};
  g.stiffness_N_m = 1000.0;
  g.damping_N_s_m = damping;
  g.friction_stiffness_N_m = 1000.0;
  g.friction_damping_N_s_m = 20.0;
  g.friction = 0.5;
  return g;
}

TEST(Ground, VehicleStartsAtRestAndFeelsGravity) {
  World world;
  const Truth& truth = world.dynamics.truth();
  EXPECT_TRUE(truth.on_ground);
  EXPECT_LT((truth.specific_force_B - Vector3(0.0, 0.0, -9.80665)).norm(), 1e-9);
  EXPECT_NEAR(truth.body.p_W.z(), -0.2 + 3.5 * 9.80665 / (4.0 * 1700.0), 1e-12);
  world.run(1.0, {});
  EXPECT_LT(truth.body.v_B.norm(), 1e-9);
}

TEST(Ground, RestingVehicleStaysWithinAMillimetreForAMinute) {
  World world;
  world.run(2.0, all_motors(0.1));
  const BodyState before = world.dynamics.truth().body;
  double farthest = 0.0;
  for (int i = 0; i < 600; ++i) {
    world.run(0.1, all_motors(0.1));
    farthest = std::max(farthest, (world.dynamics.truth().body.p_W - before.p_W).norm());
  }
  EXPECT_LT(farthest, 1e-3);
  EXPECT_LT(world.dynamics.truth().body.q_WB.angularDistance(before.q_WB), 2e-3);
  EXPECT_TRUE(world.dynamics.truth().on_ground);
}

TEST(Ground, RestingVehicleDoesNotCreepInTheWind) {
  World world({"environment.wind={steady_W_m_s: [6, 3, 0], turbulence_w20_m_s: 7.7}"});
  world.run(2.0, all_motors(0.1));
  const auto mean_position = [&world] {
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < 1000; ++i) {
      world.run(0.01, all_motors(0.1));
      sum += world.dynamics.truth().body.p_W;
    }
    return Vector3(sum / 1000.0);
  };
  const Vector3 before = mean_position();
  world.run(60.0, all_motors(0.1));
  // It sways on its legs by up to a millimetre; gusts are not the same in both means.
  EXPECT_LT((mean_position() - before).norm(), 5e-4);
}

TEST(Ground, SlideStopsAfterItsBrakingDistance) {
  const Push nothing;
  for (const double speed : {1.0, 4.0}) {
    RigidBody dynamics(body(), gear(), environment(), nothing, kRandom);
    BodyState start = dynamics.rest_state();
    start.v_B.x() = speed;
    ASSERT_TRUE(dynamics.set_state(start));
    run(dynamics, 5.0);
    EXPECT_LT(dynamics.truth().body.v_B.norm(), 1e-6);
    // v^2/(2 mu g), and the stretch of the tangential springs, mu m g/(4 k) = 2.5 mm; the braking
    // torque tips the body a little while it slides.
    EXPECT_NEAR(dynamics.truth().body.p_W.x(), speed * speed / (2.0 * 0.5 * 9.80665),
                0.004 * speed + 0.003);
    EXPECT_NEAR(dynamics.truth().body.p_W.y(), 0.0, 1e-6);
  }
}

TEST(Ground, PushBelowFrictionHoldsAndAboveMoves) {
  const double limit = 0.5 * 2.0 * 9.80665;
  for (const double share : {0.45, 1.1}) {  // a sudden push is felt twofold by a spring
    const Push push([&](const ForcesAndMoments::Input&) {
      return Wrench{{share * limit, 0.0, 0.0}, Vector3::Zero()};
    });
    RigidBody dynamics(body(), gear(), environment(), push, kRandom);
    run(dynamics, 3.0);
    const double expected = share < 1.0 ? 0.0 : 0.5 * 0.1 * 0.5 * 9.80665 * 9.0;
    EXPECT_NEAR(dynamics.truth().body.p_W.x(), expected, share < 1.0 ? 0.004 : 0.1) << share;
    EXPECT_EQ(dynamics.truth().body.v_B.x() < 1e-6, share < 1.0);
  }
}

TEST(Ground, ReboundFollowsTheDamping) {
  const Push nothing;
  for (const double damping : {5.0, 20.0}) {
    // Without gravity the closed form (3) is exact; four contacts act as one.
    RigidBody dynamics(body(), gear(damping), environment(0.0), nothing, kRandom);
    BodyState start;
    start.p_W.z() = -0.201;
    start.v_B.z() = 1.0;
    ASSERT_TRUE(dynamics.set_state(start));
    run(dynamics, 0.5, 100);
    const double zeta = 4.0 * damping / (2.0 * std::sqrt(4.0 * 1000.0 * 2.0));
    const double root = std::sqrt(1.0 - zeta * zeta);
    const double expected = std::exp(-2.0 * zeta / root * std::atan2(root, zeta));
    // The steps at which contact begins and ends are not resolved: h a = 0.1 ms of 40 m/s^2 at the
    // most.
    EXPECT_NEAR(-dynamics.truth().body.v_B.z(), expected, 4e-3) << damping;
  }
}

/// Drops the default quadrotor tilted and lets it settle; returns the highest point of the centre
/// of mass.
double drop(World& world, double tilt_rad, double fall_m_s) {
  BodyState start = world.dynamics.rest_state();
  start.p_W.z() = -0.6;
  start.q_WB = Quaternion(Eigen::AngleAxisd(tilt_rad, Vector3(1.0, 0.5, 0.0).normalized()));
  start.v_B = start.q_WB.conjugate() * Vector3(0.5, 0.0, fall_m_s);
  EXPECT_TRUE(world.dynamics.set_state(start));
  double highest = 0.0;
  for (int i = 0; i < 1000; ++i) {
    world.run(0.01, {});
    highest = std::max(highest, -world.dynamics.truth().body.p_W.z());
  }
  EXPECT_LT(world.dynamics.truth().body.v_B.norm(), 1e-6);
  EXPECT_LT(world.dynamics.truth().body.w_B.norm(), 1e-6);
  EXPECT_TRUE(world.dynamics.truth().on_ground);
  return highest;
}

TEST(Ground, TiltedLandingSettlesUpright) {
  World world;
  EXPECT_LT(drop(world, 0.2, 0.5), 0.6);  // no energy comes from nowhere
  EXPECT_NEAR(world.dynamics.truth().body.p_W.z(), world.dynamics.rest_state().p_W.z(), 1e-5);
  EXPECT_GT(world.dynamics.truth().body.q_WB.toRotationMatrix()(2, 2), 1.0 - 1e-6);
}

TEST(Ground, TippedVehicleLiesOnItsRotors) {
  World world;
  drop(world, 2.8, 1.0);
  EXPECT_LT(world.dynamics.truth().body.q_WB.toRotationMatrix()(2, 2), -0.99);
  EXPECT_NEAR(-world.dynamics.truth().body.p_W.z(), 0.0762 - 3.5 * 9.80665 / (4.0 * 1700.0), 1e-5);
}

TEST(Ground, UnevenGearRestsOnItsLowestPoints) {
  GroundParameters g = gear();
  g.contacts_B.emplace_back(0.0, 0.0, 0.1);
  EXPECT_NEAR(GroundContact(g).rest_height_m(40.0), 0.2 - 40.0 / 4000.0, 1e-12);
  // Heavy enough to press on all five: 4 k (0.2 - h) + k (0.1 - h) = W.
  EXPECT_NEAR(GroundContact(g).rest_height_m(900.0), (0.9 - 0.9) / 5.0, 1e-12);
}

TEST(Ground, ReferencePlaneStopsTheFallOnly) {
  World world(reference_options());
  EXPECT_EQ(world.dynamics.truth().body.p_W.z(), 0.0);
  EXPECT_TRUE(world.dynamics.truth().on_ground);
  world.run(1.0, all_motors(0.0));
  EXPECT_EQ(world.dynamics.truth().body.p_W.z(), 0.0);
  EXPECT_NEAR(world.dynamics.truth().specific_force_B.z(), -9.81, 1e-12);
  BodyState slide = world.dynamics.rest_state();
  slide.v_B.x() = 1.0;
  ASSERT_TRUE(world.dynamics.set_state(slide));
  world.run(1.0, all_motors(0.0));
  EXPECT_GT(world.dynamics.truth().body.v_B.x(), 0.98);  // body drag alone slows it
}

TEST(Ground, ReferenceHoverPointHolds) {
  World world(reference_options());
  BodyState start;
  start.p_W.z() = -10.0;
  ASSERT_TRUE(world.dynamics.set_state(start));
  world.run(1.0, all_motors(0.479918));
  // Thrust is right to 2e-5 N, the integration exact: 0.5 (8e-5/3.5) m.
  EXPECT_NEAR(world.dynamics.truth().body.p_W.z(), -10.0, 2e-5);
}

}  // namespace
}  // namespace rosflight::sim::test
