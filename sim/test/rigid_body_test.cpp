// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/rigid_body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/test/world.hpp"
#include "test_support/allocations.hpp"

namespace rosflight::sim::test {
namespace {

TEST(RigidBody, FallsFreelyAndFeelsNothing) {
  const Push nothing;
  RigidBody dynamics(body(), {}, environment(), nothing, kRandom);
  BodyState start;
  start.q_WB = Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  start.p_W = {1.0, 2.0, -100.0};
  start.v_B = start.q_WB.conjugate() * Vector3(3.0, 0.0, 0.0);
  ASSERT_TRUE(dynamics.set_state(start));
  run(dynamics, 2.0);
  const Truth& truth = dynamics.truth();
  // A parabola is integrated exactly; what is left is rounding.
  EXPECT_LT((truth.body.p_W - Vector3(7.0, 2.0, -100.0 + 0.5 * 9.80665 * 4.0)).norm(), 1e-11);
  EXPECT_EQ(truth.specific_force_B, Vector3::Zero());
  EXPECT_FALSE(truth.on_ground);
}

TEST(RigidBody, TorqueFreeSpinKeepsEnergyAndAngularMomentum) {
  const Push nothing;
  RigidBody dynamics(body(), {}, environment(0.0), nothing, kRandom);
  BodyState start;
  start.w_B = {0.3, 6.0, 0.2};  // about the middle axis: it tumbles
  ASSERT_TRUE(dynamics.set_state(start));
  const Vector3 j(0.08, 0.10, 0.15);
  const auto energy = [&](const BodyState& s) { return 0.5 * s.w_B.dot(j.cwiseProduct(s.w_B)); };
  const auto momentum = [&](const BodyState& s) { return Vector3(s.q_WB * j.cwiseProduct(s.w_B)); };
  const double energy_start = energy(start);
  const Vector3 momentum_start = momentum(start);
  double lowest = 6.0;
  for (int i = 0; i < 4000; ++i) {
    run(dynamics, 0.0025);
    lowest = std::min(lowest, dynamics.truth().body.w_B.y());
  }
  EXPECT_LT(lowest, -5.0);  // it did tumble
  // Fourth order at 2.5 ms: h^4 w^5/120 per second = 2.5e-9 relative, over 10 s.
  EXPECT_NEAR(energy(dynamics.truth().body) / energy_start, 1.0, 1e-7);
  EXPECT_LT((momentum(dynamics.truth().body) - momentum_start).norm() / momentum_start.norm(),
            1e-7);
}

TEST(RigidBody, PrecessesAsEulerSays) {
  // Symmetric top: w_x + i w_y turns with (J3 - J1)/J1 w_z, closed form.
  const Push nothing;
  RigidBody dynamics(body({0.1, 0.1, 0.15}), {}, environment(0.0), nothing, kRandom);
  BodyState start;
  start.w_B = {1.0, 0.0, 4.0};
  ASSERT_TRUE(dynamics.set_state(start));
  EXPECT_NEAR(dynamics.truth().angular_acceleration_B.y(), 0.5 * 4.0 * 1.0,
              1e-12);  // gyroscopic term is there
  run(dynamics, 1.0);
  EXPECT_NEAR(dynamics.truth().body.w_B.x(), std::cos(2.0), 1e-9);
  EXPECT_NEAR(dynamics.truth().body.w_B.y(), std::sin(2.0), 1e-9);
}

TEST(RigidBody, SteadySpinTurnsByItsAngle) {
  const Push nothing;
  RigidBody dynamics(body(), {}, environment(0.0), nothing, kRandom);
  BodyState start;
  start.w_B = {0.0, 0.0, 3.0};
  ASSERT_TRUE(dynamics.set_state(start));
  run(dynamics, 1.0);
  const Quaternion expected(Eigen::AngleAxisd(3.0, Vector3::UnitZ()));
  EXPECT_LT(dynamics.truth().body.q_WB.angularDistance(expected), 1e-9);
  EXPECT_NEAR(dynamics.truth().body.q_WB.norm(), 1.0, 1e-15);
}

TEST(RigidBody, InertiaElementsAreThoseOfTheMatrix) {
  // Two masses of 1 kg at +-(0.3, 0, 0.4) and a sphere of 0.1 kg m^2: J_xz = -sum m x z = -0.24.
  BodyParameters b = body();
  b.inertia_kg_m2 << 0.42, 0.0, -0.24, 0.0, 0.6, 0.0, -0.24, 0.0, 0.28;
  const Push roll(
      [](const ForcesAndMoments::Input&) { return Wrench{Vector3::Zero(), {1.0, 0.0, 0.0}}; });
  RigidBody dynamics(b, {}, environment(), roll, kRandom);
  const Vector3 alpha = dynamics.truth().angular_acceleration_B;
  EXPECT_LT((b.inertia_kg_m2 * alpha - Vector3(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_GT(alpha.z(), 0.0);  // rolling right, the masses drag the nose right
}

double order_of_convergence(Integration integration) {
  // Everything coupled: force and torque depend on attitude, rate and speed.
  const Push push([](const ForcesAndMoments::Input& in) {
    const Vector3 down_B = in.R_WB.row(2).transpose();
    Wrench w;
    w.force_B = Vector3(0.0, 0.0, -18.0) - 0.3 * in.v_air_B.norm() * in.v_air_B + 2.0 * in.body.w_B;
    w.torque_B =
        0.8 * down_B.cross(Vector3(0.0, 0.3, 1.0)) - 0.02 * in.body.w_B + 0.01 * in.v_air_B;
    return w;
  });
  const auto end_of = [&](double step_s) {
    BodyParameters b = body();
    b.integration = integration;
    b.max_step_s = step_s;
    RigidBody dynamics(b, {}, environment(), push, kRandom);
    BodyState start;
    start.v_B = {5.0, 1.0, -2.0};
    start.w_B = {2.0, -1.0, 1.5};
    EXPECT_TRUE(dynamics.set_state(start));
    run(dynamics, 1.6, 1'600'000);
    return dynamics.truth().body;
  };
  const BodyState truth = end_of(0.0005);
  const auto error = [&](double step_s) {
    const BodyState end = end_of(step_s);
    return (end.p_W - truth.p_W).norm() + (end.v_B - truth.v_B).norm() +
           (end.w_B - truth.w_B).norm() + end.q_WB.angularDistance(truth.q_WB);
  };
  return std::log2(error(0.04) / error(0.02));
}

TEST(RigidBody, ConvergesWithFourthOrder) {
  EXPECT_NEAR(order_of_convergence(Integration::kRk4), 4.0, 0.25);
}

TEST(RigidBody, FrozenForcesConvergeWithFirstOrderOnly) {
  EXPECT_NEAR(order_of_convergence(Integration::kFrozenForces), 1.0, 0.25);
}

TEST(RigidBody, QuadrotorInFlightConvergesWithFourthOrder) {
  const auto end_of = [](const std::string& step_s) {
    // Without the bends of the model: current limit, rotor drag from zero thrust on, still air
    // below the rotors.
    World world({"body.max_step_s=" + step_s, "ground.model=none",
                 "environment.atmosphere.model=constant",
                 "environment.atmosphere.density_kg_m3=1.2", "rotors.motor.current_limit_A=10000",
                 "aero.rotor_drag_s_m=0"});
    BodyState start;
    start.v_B = {3.0, 1.0, -9.0};
    start.w_B = {0.5, -0.3, 0.2};
    EXPECT_TRUE(world.dynamics.set_state(start));
    hal::OutputValues outputs = all_motors(0.6);
    outputs[0] = 0.61F;
    world.run(0.4, outputs, hal::microseconds(400'000));
    return world.dynamics.truth();
  };
  const Truth truth = end_of("0.0001");
  const auto error = [&](const std::string& step_s) {
    const Truth end = end_of(step_s);
    return (end.body.p_W - truth.body.p_W).norm() + (end.body.v_B - truth.body.v_B).norm() +
           std::abs(end.rotor_speed_rad_s[0] - truth.rotor_speed_rad_s[0]);
  };
  EXPECT_NEAR(std::log2(error("0.005") / error("0.0025")), 4.0, 0.3);
}

TEST(RigidBody, TerminalSpeedIsThatOfTheDrag) {
  // sqrt(2 m g/(rho C_D A)): 26.15 m/s with ROSflight 2.x's numbers.
  World world({"environment.gravity_m_s2=9.81", "environment.atmosphere.model=constant",
               "environment.atmosphere.density_kg_m3=1.225", "ground.model=none"});
  world.run(30.0, all_motors(0.0));
  EXPECT_NEAR(world.dynamics.truth().body.v_B.z(), std::sqrt(2.0 * 3.5 * 9.81 / (1.225 * 0.082)),
              1e-6);
  EXPECT_NEAR(world.dynamics.truth().body.v_B.z(), 26.15, 0.005);
}

TEST(RigidBody, LongStepsAreSplit) {
  World one;
  World many;
  one.run(1.0, all_motors(0.55), hal::microseconds(1'000'000));
  many.run(1.0, all_motors(0.55));
  // Only the air is looked up less often: a relative 1e-4 of density per metre climbed.
  EXPECT_LT((one.dynamics.truth().body.p_W - many.dynamics.truth().body.p_W).norm(), 1e-3);
  EXPECT_GT(one.dynamics.truth().body.p_W.norm(), 0.5);
}

TEST(RigidBody, TimeThatStandsOrRunsBackwardsMovesNothing) {
  World world;
  world.run(0.1, all_motors(0.6));
  const BodyState before = world.dynamics.truth().body;
  world.dynamics.step(world.dynamics.truth().time, all_motors(0.6));
  world.dynamics.step(hal::microseconds(0), all_motors(0.6));
  EXPECT_EQ(world.dynamics.truth().body.p_W, before.p_W);
  EXPECT_EQ(world.dynamics.truth().time, hal::microseconds(100'000));
}

TEST(RigidBody, AirIsThatOfTheHeight) {
  World world({"ground.model=none"});
  BodyState high;
  high.p_W.z() = -613.0;  // 2000 m above the sea
  ASSERT_TRUE(world.dynamics.set_state(high));
  EXPECT_NEAR(world.dynamics.truth().air.pressure_Pa, 7.9501e4,
              0.6);  // US Standard Atmosphere 1976, table I
  EXPECT_NEAR(world.dynamics.truth().air.density_kg_m3, 1.0066, 6e-5);
}

TEST(RigidBody, ImpossibleStatesAreRefused) {
  World world;
  const BodyState before = world.dynamics.truth().body;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BodyState s = world.dynamics.rest_state();
  s.v_B.x() = nan;
  EXPECT_FALSE(world.dynamics.set_state(s));
  s = world.dynamics.rest_state();
  s.q_WB = Quaternion(0.0, 0.0, 0.0, 0.0);
  EXPECT_FALSE(world.dynamics.set_state(s));
  s = world.dynamics.rest_state();
  s.p_W.z() = 1.0;
  EXPECT_FALSE(world.dynamics.set_state(s));
  s.p_W.z() = -0.1;  // the gear would be 10 cm under ground
  EXPECT_FALSE(world.dynamics.set_state(s));
  EXPECT_EQ(world.dynamics.truth().body.p_W, before.p_W);
  s.p_W.z() = -5.0;
  s.q_WB = Quaternion(2.0, 0.0, 0.0, 2.0);
  EXPECT_TRUE(world.dynamics.set_state(s));
  EXPECT_NEAR(world.dynamics.truth().body.q_WB.norm(), 1.0, 1e-15);
  EXPECT_EQ(world.dynamics.truth().body.p_W.z(), -5.0);
}

TEST(RigidBody, SameSeedSameFlightOtherSeedOtherFlight) {
  const auto fly = [](std::uint64_t seed) {
    World world({"environment.wind={steady_W_m_s: [3, 0, 0], turbulence_w20_m_s: 8}"}, seed);
    world.run(3.0, all_motors(0.6));
    return world.dynamics.truth().body;
  };
  EXPECT_EQ(fly(5).p_W, fly(5).p_W);
  EXPECT_EQ(fly(5).q_WB.coeffs(), fly(5).q_WB.coeffs());
  EXPECT_NE(fly(5).p_W, fly(6).p_W);
}

/// A spring to the height of 100 m, of an angular frequency, in place of the module's forces.
class Spring final : public ExternalWrench {
 public:
  Spring(double mass_kg, double omega_rad_s) : mass_kg_{mass_kg}, omega_rad_s_{omega_rad_s} {}
  void change(const ForcesAndMoments::Input& in, Wrench& wrench) override {
    ++calls;
    seen_force = wrench.force_B.x();
    const double away_m = in.body.p_W.z() + 100.0;
    wrench.force_B = {0.0, 0.0, -mass_kg_ * omega_rad_s_ * omega_rad_s_ * away_m};
  }

  int calls{0};
  double seen_force{0.0};

 private:
  double mass_kg_, omega_rad_s_;
};

TEST(RigidBody, AWrenchFromOutsideActsAtEachStage) {
  // Closed form z = cos(w t). Fourth order: h^4 w^5 t/120 = 3e-8 of the amplitude.
  constexpr double kOmega = 8.0;
  const Push forward([](const auto&) { return Wrench{{5.0, 0.0, 0.0}, Vector3::Zero()}; });
  RigidBody dynamics(body(), {}, environment(0.0), forward, kRandom);
  BodyState start;
  start.p_W.z() = -99.0;
  ASSERT_TRUE(dynamics.set_state(start));
  Spring spring(2.0, kOmega);
  dynamics.set_external_wrench(&spring);
  run(dynamics, 3.0);
  EXPECT_EQ(spring.calls, 4 * 1200);
  EXPECT_EQ(spring.seen_force, 5.0);  // it sees what the module computed
  EXPECT_NEAR(dynamics.truth().body.p_W.z(), -100.0 + std::cos(kOmega * 3.0), 1e-7);
  EXPECT_EQ(dynamics.truth().body.p_W.x(), 0.0);  // which it has replaced
  EXPECT_NEAR(dynamics.truth().specific_force_B.z(), -kOmega * kOmega * std::cos(kOmega * 3.0),
              1e-4);  // of the last stage, whose state is off by O(h^3)
  dynamics.set_external_wrench(nullptr);
  run(dynamics, 0.0025);
  EXPECT_EQ(spring.calls, 4 * 1200);
  EXPECT_EQ(dynamics.truth().specific_force_B.x(), 2.5);
}

TEST(RigidBody, SteppingTakesNoHeap) {
  World world(
      {"environment.wind={steady_W_m_s: [3, 0, 0], turbulence_w20_m_s: 8, gusts: {mean_interval_s: "
       "0.1}}"});
  const std::size_t before = test_support::allocations();
  world.run(5.0, all_motors(0.6));
  EXPECT_EQ(test_support::allocations(), before);
}

}  // namespace
}  // namespace rosflight::sim::test
