// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/physics_engine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/dynamics/runge_kutta_engine.hpp"
#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kGravity_m_s2 = 9.80665;

TEST(RungeKuttaEngine, ThrowsAParabola) {
  RungeKuttaEngine engine(body(), kGravity_m_s2);
  BodyState start;
  start.q_WB = Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  start.v_B = start.q_WB.conjugate() * Vector3(3.0, 0.0, -5.0);
  start.w_B = {0.3, -0.2, 0.5};
  engine.set_state(start);
  for (int i = 0; i < 400; ++i) engine.step(0.0025, {{4.0, 0.0, 0.0}, Vector3::Zero()});
  // 4 N on 2 kg; gravity downwards.
  EXPECT_LT((engine.state().p_W - Vector3(3.0 + 1.0, 0.0, -5.0 + 0.5 * kGravity_m_s2)).norm(),
            1e-9);
  EXPECT_EQ(engine.contact(), nullptr);
}

TEST(RungeKuttaEngine, TurnsByHalfAlphaTSquared) {
  RungeKuttaEngine engine(body(), 0.0);
  engine.set_state({});
  for (int i = 0; i < 400; ++i) engine.step(0.0025, {Vector3::Zero(), {0.0, 0.0, 0.3}});
  // 0.3 N m on 0.15 kg m^2.
  EXPECT_NEAR(engine.state().w_B.z(), 2.0, 1e-12);
  const Quaternion expected(Eigen::AngleAxisd(1.0, Vector3::UnitZ()));
  EXPECT_LT(engine.state().q_WB.angularDistance(expected), 1e-9);
}

/// Thrust along the body, drag and damping: a load that changes with the motion.
Wrench thrust_and_drag(const ForcesAndMoments::Input& in) {
  return {Vector3(0.0, 0.0, -25.0) - 0.1 * in.v_air_B.norm() * in.v_air_B,
          Vector3(0.1, -0.05, 0.02) - 0.2 * in.body.w_B};
}

/// Position after 1 s from a turning start, moved in steps of this length.
Vector3 flown_W(std::int64_t step_us, PhysicsEngine* engine) {
  const Push forces(thrust_and_drag);
  RigidBody dynamics(body(), {}, environment(kGravity_m_s2), forces, kRandom);
  if (engine != nullptr) dynamics.set_engine(*engine);
  BodyState start;
  start.v_B = {5.0, 1.0, 0.0};
  start.w_B = {0.5, -0.4, 1.0};
  EXPECT_TRUE(dynamics.set_state(start));
  run(dynamics, 1.0, step_us);
  return dynamics.truth().body.p_W;
}

double coupling_error_m(std::int64_t step_us) {
  RungeKuttaEngine engine(body(), kGravity_m_s2);
  return (flown_W(step_us, &engine) - flown_W(100, nullptr)).norm();
}

TEST(RigidBodyByEngine, FliesAsByItselfToSecondOrder) {
  const double coarse = coupling_error_m(2000);
  const double fine = coupling_error_m(1000);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_GT(coarse, 1e-9);  // the engine did fly it
  EXPECT_NEAR(coarse / fine, 4.0, 0.1);
}

TEST(RigidBodyByEngine, StandsOnTheGroundOfTheVehicleFile) {
  World world;
  RungeKuttaEngine engine(world.vehicle.body(), world.vehicle.environment().gravity_m_s2);
  world.dynamics.set_engine(engine);
  world.run(2.0, {});
  EXPECT_TRUE(world.dynamics.truth().on_ground);
  EXPECT_LT((world.dynamics.truth().body.p_W - world.dynamics.rest_state().p_W).norm(), 1e-6);
  EXPECT_NEAR(world.dynamics.truth().specific_force_B.z(),
              -world.vehicle.environment().gravity_m_s2, 1e-6);
}

TEST(RigidBodyByEngine, StartsWhereTheBodyIsSet) {
  World world;
  RungeKuttaEngine engine(world.vehicle.body(), world.vehicle.environment().gravity_m_s2);
  world.dynamics.set_engine(engine);
  EXPECT_EQ(engine.state().p_W, world.dynamics.rest_state().p_W);
  BodyState state;
  state.p_W = {1.0, 2.0, -3.0};
  ASSERT_TRUE(world.dynamics.set_state(state));
  EXPECT_EQ(engine.state().p_W, state.p_W);
}

/// Holds the body where it is, on ground of its own.
class Shelf final : public PhysicsEngine {
 public:
  void set_state(const BodyState& state) override { state_ = state; }
  void step(double, const Load& load) override {
    contact_.touches = contact_.carries = true;
    contact_.wrench.force_B = {0.0, 0.0, -kGravity_m_s2 * 2.0 - load.force_W.z()};
  }
  const BodyState& state() const override { return state_; }
  const Contact* contact() const override { return &contact_; }

 private:
  BodyState state_;
  Contact contact_;
};

TEST(RigidBodyByEngine, GroundOfTheEngineTakesThePlaceOfTheFiles) {
  GroundParameters ground;
  ground.model = GroundModel::kFrictionlessPlane;
  const Push lift(
      [](const ForcesAndMoments::Input&) { return Wrench{{0.0, 0.0, -5.0}, Vector3::Zero()}; });
  RigidBody dynamics(body(), ground, environment(kGravity_m_s2), lift, kRandom);
  Shelf shelf;
  dynamics.set_engine(shelf);
  run(dynamics, 0.1);
  EXPECT_TRUE(dynamics.truth().on_ground);
  // 5 N of lift and the rest from the shelf, 2 kg.
  EXPECT_NEAR(dynamics.truth().specific_force_B.z(), -kGravity_m_s2, 1e-12);
  EXPECT_EQ(dynamics.truth().wrench.force_B.z(), -5.0);
}

/// Hits a wall in its first step and a floor in its fourth one.
class Bumps final : public PhysicsEngine {
 public:
  void set_state(const BodyState& state) override { state_ = state; }
  void step(double, const Load&) override {
    contact_ = {};
    ++steps_;
    if (steps_ == 1) {
      contact_.touches = contact_.airframe = true;
      contact_.approach_m_s = 2.5;
      contact_.other = "wall";
      contact_.wrench = {{-40.0, 0.0, 0.0}, {0.0, 0.0, 3.0}};
    } else if (steps_ == 4) {
      contact_.touches = contact_.carries = true;
      contact_.approach_m_s = 0.1;
      contact_.normal_up = 1.0;
      contact_.other = "floor";
    }
  }
  const BodyState& state() const override { return state_; }
  const Contact* contact() const override { return &contact_; }

 private:
  int steps_{0};
  BodyState state_;
  Contact contact_;
};

const Push kNoForce([](const ForcesAndMoments::Input&) { return Wrench{}; });

TEST(RigidBodyByEngine, ContactsOfEachSubstepCount) {
  BodyParameters split = body();
  split.max_step_s = 0.0005;
  RigidBody dynamics(split, {}, environment(0.0), kNoForce, kRandom);
  EXPECT_FALSE(dynamics.take_contact());
  Bumps bumps;
  dynamics.set_engine(bumps);
  dynamics.step(Time{2500}, {});
  EXPECT_TRUE(dynamics.truth().on_ground);
  // A fifth of 40 N on 2 kg, and of 3 N m on 0.15 kg m^2.
  EXPECT_NEAR(dynamics.truth().specific_force_B.x(), -4.0, 1e-12);
  EXPECT_NEAR(dynamics.truth().angular_acceleration_B.z(), 4.0, 1e-12);
  const auto contact = dynamics.take_contact();
  ASSERT_TRUE(contact);
  EXPECT_TRUE(contact->touches && contact->airframe && contact->carries);
  EXPECT_EQ(contact->approach_m_s, 2.5);
  EXPECT_EQ(contact->normal_up, 0.0);
  EXPECT_EQ(contact->other, "wall");
  dynamics.step(Time{5000}, {});
  EXPECT_FALSE(dynamics.truth().on_ground);
  EXPECT_EQ(dynamics.truth().specific_force_B.norm(), 0.0);
  EXPECT_FALSE(dynamics.take_contact()->touches);
}

TEST(RigidBodyByEngine, AContactIsKeptUntilItIsTaken) {
  RigidBody dynamics(body(), {}, environment(0.0), kNoForce, kRandom);
  Bumps bumps;
  dynamics.set_engine(bumps);
  for (int k = 1; k <= 3; ++k) dynamics.step(Time{500 * k}, {});
  EXPECT_FALSE(dynamics.truth().on_ground);
  EXPECT_EQ(dynamics.take_contact()->other, "wall");
  EXPECT_FALSE(dynamics.take_contact()->touches);
}

TEST(RigidBodyByEngine, AWallIsNoGround) {
  RigidBody dynamics(body(), {}, environment(0.0), kNoForce, kRandom);
  Bumps bumps;
  dynamics.set_engine(bumps);
  dynamics.step(Time{500}, {});
  EXPECT_FALSE(dynamics.truth().on_ground);
}

/// Pushes the body upwards, as an engine does to one that overlaps with the ground.
class Lifts final : public PhysicsEngine {
 public:
  Lifts() {
    contact_.touches = contact_.carries = true;
    contact_.wrench.force_B = {0.0, 0.0, -5.0};
  }
  void set_state(const BodyState& state) override { state_ = state; }
  void step(double h_s, const Load&) override {
    state_.v_B.z() -= 0.001;
    state_.p_W.z() += h_s * state_.v_B.z();
  }
  const BodyState& state() const override { return state_; }
  const Contact* contact() const override { return &contact_; }

 private:
  BodyState state_;
  Contact contact_;
};

TEST(RigidBodyByEngine, AHeldBodyStaysWhereItIs) {
  RigidBody dynamics(body(), {}, environment(kGravity_m_s2), kNoForce, kRandom);
  Lifts lifts;
  dynamics.set_engine(lifts);
  dynamics.set_held(true);
  run(dynamics, 1.0);
  EXPECT_EQ(dynamics.truth().body.p_W, Vector3::Zero());
  EXPECT_EQ(dynamics.truth().body.v_B, Vector3::Zero());
  EXPECT_NEAR(dynamics.truth().specific_force_B.z(), -kGravity_m_s2, 1e-12);
  EXPECT_TRUE(dynamics.truth().on_ground);
  dynamics.set_held(false);
  dynamics.step(dynamics.truth().time + Time{2500}, {});
  EXPECT_LT(dynamics.truth().body.p_W.z(), 0.0);
}

TEST(RigidBodyByEngine, FrozenForcesAreRejected) {
  World world({"body.integration=frozen_forces", "ground.model=frictionless_plane"});
  RungeKuttaEngine engine(world.vehicle.body(), kGravity_m_s2);
  try {
    world.dynamics.set_engine(engine);
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "body.integration: found frozen_forces with a physics engine, allowed rk4");
  }
}

}  // namespace
}  // namespace rosflight::sim::test
