// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fixedwing/fixedwing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/fixedwing/test/hangar.hpp"
#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Servos in the centre.
hal::OutputValues outputs_with(float throttle) {
  hal::OutputValues outputs{};
  outputs[0] = outputs[1] = outputs[2] = 0.5F;
  outputs[4] = throttle;
  return outputs;
}

/// Force of the propeller alone [N].
double propeller_N(const Hangar& hangar, float throttle, double speed_m_s, double density_kg_m3) {
  BodyState body;
  body.v_B.x() = speed_m_s;
  Air air;
  air.density_kg_m3 = density_kg_m3;
  const auto all = evaluate(hangar.forces, outputs_with(throttle), initial_states(hangar.forces),
                            body, 1000.0, air);
  Wrench airframe;
  if (speed_m_s > 0.0)
    hangar.forces.airframe().add_wrench(body.v_B, body.w_B, density_kg_m3, {}, airframe);
  return all.wrench.force_B.x() - airframe.force_B.x();
}

TEST(FixedWing, PropellersMeetTheReferencesStaticAndIdleThrust) {
  struct Row {
    double static_N;
    double idle_15_N;
  };
  const Row rows[] = {{53.18, -13.06}, {51.37, -12.40}, {51.97, -12.61}, {84.56, -8.06}};
  for (std::size_t i = 0; i < kReferenceAircraft.size(); ++i) {
    SCOPED_TRACE(kReferenceAircraft[i].name);
    const Hangar hangar(kReferenceAircraft[i]);
    const double density = kReferenceAircraft[i].density_kg_m3;
    EXPECT_NEAR(propeller_N(hangar, 1.0F, 0.0, density), rows[i].static_N, 0.006);
    EXPECT_NEAR(propeller_N(hangar, 0.0F, 15.0, density), rows[i].idle_15_N, 0.006);
  }
  const Hangar hangar(kReferenceAircraft[0]);
  Air air;
  air.density_kg_m3 = 1.2682;
  const auto all =
      evaluate(hangar.forces, outputs_with(1.0F), initial_states(hangar.forces), {}, 1000.0, air);
  EXPECT_NEAR(all.truth.rotor_speed_rad_s[0], 1117.7, 0.06);
}

TEST(FixedWing, TheReferencesModelIsCutOffBelow2MetresPerSecond) {
  const Hangar hangar(kReferenceAircraft[0]);
  BodyState body;
  body.v_B.x() = 1.99;
  const auto x = initial_states(hangar.forces);
  EXPECT_EQ(evaluate(hangar.forces, outputs_with(0.009F), x, body).wrench.force_B.norm(), 0.0);
  const Wrench slow = evaluate(hangar.forces, outputs_with(0.5F), x, body).wrench;
  EXPECT_GT(slow.force_B.x(), 5.0);
  EXPECT_EQ(slow.torque_B.norm(), 0.0);
  body.v_B.x() = 2.01;
  EXPECT_NE(evaluate(hangar.forces, outputs_with(0.5F), x, body).wrench.torque_B.x(), 0.0);
}

TEST(Airframe, HasTheCoefficientsOfTheTextbookAtAPoint) {
  const Hangar hangar("anaconda");
  const double V = 20.0;
  const double alpha = 3.0 * kDegree;
  const double beta = 2.0 * kDegree;
  const double rho = 1.1;
  const Vector3 v(V * std::cos(alpha) * std::cos(beta), V * std::sin(beta),
                  V * std::sin(alpha) * std::cos(beta));
  const Vector3 w(0.3, 0.2, -0.1);
  const Deflection d{0.05, -0.04, 0.03};
  Wrench got;
  hangar.forces.airframe().add_wrench(v, w, rho, d, got);
  // By hand; at 3 degrees 0.055 % of the flow is separated (stall at 11.6 degrees, 50 per rad).
  const double b = 2.08;
  const double c = 0.235;
  const double qS = 0.5 * rho * V * V * 0.52;
  const double s = 1.0 - (1.0 - 1.0 / (1.0 + std::exp(50.0 * (11.6 - 3.0) * kDegree))) *
                             (1.0 - 1.0 / (1.0 + std::exp(50.0 * (11.6 + 3.0) * kDegree)));
  const double linear = 0.506 + 5.61 * alpha;
  const double plate = 2.0 * std::sin(alpha) * std::sin(alpha);
  const double lift = qS * ((1 - s) * linear + s * plate * std::cos(alpha) +
                            7.95 * c * 0.2 / (2 * V) + 0.13 * -0.04);
  const double induced = linear * linear / (std::numbers::pi * 0.9 * b * b / 0.52);
  const double drag =
      qS * (0.043 + (1 - s) * induced + s * plate * std::sin(alpha) + 0.0135 * -0.04);
  EXPECT_NEAR(got.force_B.x(), -drag * std::cos(alpha) + lift * std::sin(alpha), 1e-9);
  EXPECT_NEAR(got.force_B.z(), -drag * std::sin(alpha) - lift * std::cos(alpha), 1e-9);
  EXPECT_NEAR(got.force_B.y(), qS * (-0.98 * beta + 0.075 * 0.05 + 0.19 * 0.03), 1e-9);
  const double p = b * 0.3 / (2 * V);
  const double r = b * -0.1 / (2 * V);
  EXPECT_NEAR(got.torque_B.x(),
              qS * b * (-0.13 * beta - 0.51 * p + 0.25 * r + 0.17 * 0.05 + 0.0024 * 0.03), 1e-9);
  EXPECT_NEAR(got.torque_B.y(),
              qS * c *
                  ((1 - s) * (0.135 - 2.74 * alpha) + s * plate * -2.74 / 5.61 -
                   38.21 * c * 0.2 / (2 * V) - 0.99 * -0.04),
              1e-9);
  EXPECT_NEAR(got.torque_B.z(),
              qS * b * (0.1301 * beta - 0.0364 * p - 0.1541 * r - 0.011 * 0.05 - 0.069 * 0.03),
              1e-9);
}

TEST(Airframe, LiftPeaksAtTheStatedCoefficientBelowTheStallAngle) {
  for (const char* name : {"anaconda", "openvsp_anaconda", "xflr5_anaconda"}) {
    SCOPED_TRACE(name);
    const Hangar hangar(name);
    const Airframe& wing = hangar.forces.airframe();
    double peak = 0.0;
    double at_deg = 0.0;
    for (double deg = 0.0; deg < 20.0; deg += 0.01) {
      const double lift = wing.lift_coefficient(deg * kDegree);
      if (lift > peak) {
        peak = lift;
        at_deg = deg;
      }
    }
    EXPECT_NEAR(peak, 1.26, 0.005);
    EXPECT_GT(at_deg, 7.0);
    EXPECT_LT(at_deg, 10.0);
    EXPECT_NEAR(wing.separation(wing.parameters().stall_angle_rad), 0.5, 1e-8);
    // Cruise at 15 m/s is not touched.
    EXPECT_LT(wing.separation(1.0 * kDegree), 2e-4);
  }
}

// McCormick: at a tenth of the span 2.56/3.56 of the induced drag is left.
TEST(Airframe, GroundTakesInducedDragAway) {
  const Hangar high("anaconda");
  const Hangar low("anaconda", {"aero.ground_effect=mccormick"});
  const auto drag = [](const Hangar& hangar, double height_m) {
    Wrench wrench;
    hangar.forces.airframe().add_wrench({15, 0, 0}, Vector3::Zero(), 1.2, {}, wrench, height_m);
    return -wrench.force_B.x();
  };
  EXPECT_NEAR(low.forces.airframe().induced_share(0.208), 2.56 / 3.56, 1e-12);
  EXPECT_EQ(high.forces.airframe().induced_share(0.208), 1.0);
  // Level at 15 m/s: C_L0 = 0.506, 0.005 % separated.
  const double induced_drag_N =
      0.5 * 1.2 * 225.0 * 0.52 * 0.506 * 0.506 / (std::numbers::pi * 0.9 * 8.32);
  EXPECT_NEAR(drag(high, 0.208) - drag(low, 0.208), induced_drag_N * (1.0 - 2.56 / 3.56), 1e-3);
  EXPECT_NEAR(drag(low, 20.8), drag(high, 20.8), 1e-4 * induced_drag_N);
}

TEST(Airframe, AForwardMassPitchesTheNoseDown) {
  const Hangar centred("anaconda");
  const Hangar forward("anaconda", {"body.center_of_mass_m=[0.02, 0, 0]"});
  const auto wrench = [](const Hangar& hangar) {
    Wrench out;
    hangar.forces.airframe().add_wrench({15, 0, 1}, Vector3::Zero(), 1.2, {}, out);
    return out;
  };
  const Wrench with = wrench(forward);
  EXPECT_EQ(with.force_B, wrench(centred).force_B);
  // Lift, along -z, acts 2 cm behind the mass.
  EXPECT_NEAR(with.torque_B.y() - wrench(centred).torque_B.y(), 0.02 * with.force_B.z(), 1e-9);
  EXPECT_LT(with.force_B.z(), 0.0);
}

TEST(Airframe, IsAPlateFarBeyondTheStall) {
  const Hangar hangar("anaconda");
  const Airframe& wing = hangar.forces.airframe();
  const double qS = 0.5 * 1.2 * 100.0 * 0.52;
  Wrench flat;
  wing.add_wrench({0, 0, 10}, Vector3::Zero(), 1.2, {}, flat);
  EXPECT_NEAR(flat.force_B.z(), -qS * (2.0 + 0.043), 1e-9);  // drag of a plate across the flow
  EXPECT_NEAR(flat.force_B.x(), 0.0, 1e-9);
  EXPECT_NEAR(flat.torque_B.y(), -qS * 0.235 * 2.0 * 2.74 / 5.61, 1e-9);
  // Backwards: continuous over the cut at 180 degrees.
  Wrench above;
  Wrench below;
  wing.add_wrench({-10, 0, 1e-9}, Vector3::Zero(), 1.2, {}, above);
  wing.add_wrench({-10, 0, -1e-9}, Vector3::Zero(), 1.2, {}, below);
  EXPECT_LT((above.force_B - below.force_B).norm(), 1e-6);
  EXPECT_LT((above.torque_B - below.torque_B).norm(), 1e-6);
}

TEST(Airframe, HoldsAtRestAndTakesAnyNumber) {
  const Hangar hangar("anaconda");
  Wrench rest;
  hangar.forces.airframe().add_wrench(Vector3::Zero(), {1, 2, 3}, 1.2, {}, rest);
  EXPECT_EQ(rest.force_B.norm(), 0.0);
  EXPECT_EQ(rest.torque_B.norm(), 0.0);
}

TEST(FixedWing, AServoFollowsWithItsLagAndItsRate) {
  const double travel = 40.0 * kDegree;
  // Without a limit: the closed form of a first-order lag.
  Hangar lag("anaconda", {"surfaces.time_constant_s=0.05", "surfaces.rate_limit_deg_s=100000",
                          "ground.model=none"});
  hal::OutputValues outputs = outputs_with(0.0F);
  outputs[0] = 0.75F;
  lag.dynamics.step(hal::microseconds(50000), outputs);
  EXPECT_NEAR(lag.dynamics.truth().aileron_rad, 0.5 * travel * (1.0 - std::exp(-1.0)), 1e-7);
  // With one: a straight line.
  Hangar limited("anaconda", {"surfaces.rate_limit_deg_s=100", "ground.model=none"});
  outputs[0] = 1.0F;
  limited.dynamics.step(hal::microseconds(100000), outputs);
  EXPECT_NEAR(limited.dynamics.truth().aileron_rad / kDegree, 10.0, 1e-9);
  // Not a number: stays.
  outputs[0] = std::nanf("");
  limited.dynamics.step(hal::microseconds(200000), outputs);
  EXPECT_NEAR(limited.dynamics.truth().aileron_rad / kDegree, 10.0, 1e-9);
}

TEST(FixedWing, AStuckSurfaceKeepsItsDeflectionUntilItIsFree) {
  Hangar hangar("anaconda", {"ground.model=none"});
  hal::OutputValues outputs = outputs_with(0.0F);
  outputs[0] = 0.75F;
  outputs[1] = outputs[2] = 0.5F;
  hangar.dynamics.step(hal::microseconds(200'000), outputs);
  const double before = hangar.dynamics.truth().aileron_rad;
  EXPECT_NEAR(before / kDegree, 20.0, 1e-3);
  hangar.forces.set_surface_stuck(0, true);
  hangar.forces.set_surface_stuck(99, true);  // there is none: nothing happens
  outputs[0] = 0.0F;
  hangar.dynamics.step(hal::microseconds(400'000), outputs);
  EXPECT_EQ(hangar.dynamics.truth().aileron_rad, before);
  hangar.forces.set_surface_stuck(0, false);
  hangar.dynamics.step(hal::microseconds(800'000), outputs);
  EXPECT_NEAR(hangar.dynamics.truth().aileron_rad / kDegree, -40.0, 1e-3);
}

TEST(FixedWing, WindmillsWithoutThrottleAndLosesItsThrustWithItsMotor) {
  Hangar hangar("anaconda", {"ground.model=none"});
  Trim trim = hangar.trim({15.0, 0.0, 0.0, 0.0});
  ASSERT_TRUE(hangar.dynamics.set_state(trim.body, trim.module_state));
  hangar.forces.set_thrust_factor(0, 0.0);
  for (int i = 1; i <= 800; ++i) hangar.dynamics.step(hal::microseconds(2500 * i), trim.outputs);
  const Truth& truth = hangar.dynamics.truth();
  EXPECT_GT(truth.rotor_speed_rad_s[0], 200.0);  // the wind turns it
  Wrench airframe;
  hangar.forces.airframe().add_wrench(truth.body.v_B, truth.body.w_B, truth.air.density_kg_m3,
                                      {truth.aileron_rad, truth.elevator_rad, truth.rudder_rad},
                                      airframe);
  const double drag_N = airframe.force_B.x() - truth.wrench.force_B.x();
  EXPECT_GT(drag_N, 0.0);
  EXPECT_LT(drag_N, 1.5);  // ROSflight 2.x's braked propeller: 13 N
}

TEST(FixedWing, RefusesWhatCannotFly) {
  const auto message = [](const std::string& option) -> std::string {
    try {
      const Hangar hangar("anaconda", {option});
    } catch (const config::Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message("surfaces.layout.1.output=4"),
            "--set surfaces.layout.1.output=4: surfaces.layout.1.output: found 4 again, allowed "
            "each output once, rotors included");
  EXPECT_EQ(message("surfaces.layout.0.aileron=0").substr(0, 20), "vehicles/anaconda.ya");
  EXPECT_NE(message("surfaces.layout.0.aileron=0").find("found no effect, allowed aileron"),
            std::string::npos);
  EXPECT_NE(message("surfaces.time_constant_s=0.001").find("allowed 0 or a number from 0.002"),
            std::string::npos);
  EXPECT_NE(message("aero.lift.alpha=0").find("found 0, allowed a number > 0"), std::string::npos);
  EXPECT_NE(message("aero.side={zero: 0, beta: -1}").find("aero.side.p: found nothing, allowed"),
            std::string::npos);
  EXPECT_NE(message("aero.wing.span=2").find("span"), std::string::npos);
  EXPECT_EQ(message("aero.model=glider"),
            "--set aero.model=glider: aero.model: found glider, allowed stall, reference");
}

TEST(FixedWing, StandsOnItsWheels) {
  Hangar hangar("anaconda");
  run(hangar.dynamics, 5.0);
  const Truth& truth = hangar.dynamics.truth();
  EXPECT_TRUE(truth.on_ground);
  EXPECT_LT(truth.body.v_B.norm(), 1e-3);
  EXPECT_NEAR(truth.body.p_W.z(), -0.19, 0.01);
  const double pitch = std::asin(-truth.body.q_WB.toRotationMatrix()(2, 0));
  EXPECT_LT(std::abs(pitch), 2.0 * kDegree);
}

TEST(GroundContact, WheelsRollAlongAndHoldAcross) {
  GroundParameters ground;
  ground.model = GroundModel::kContact;
  ground.contacts_B = {{0.4, 0, 0.2}, {-0.4, 0.3, 0.2}, {-0.4, -0.3, 0.2}};
  ground.wheels = 3;
  ground.stiffness_N_m = 2000;
  ground.damping_N_s_m = 60;
  ground.friction_stiffness_N_m = 2000;
  ground.friction_damping_N_s_m = 30;
  ground.friction = 0.6;
  ground.rolling_friction = 0.05;
  const Push nothing;
  const auto slide = [&](const Vector3& v_W, double heading) {
    RigidBody dynamics(body({0.3, 0.3, 0.5}), ground, environment(), nothing, kRandom);
    BodyState start = dynamics.rest_state();
    start.q_WB = Eigen::AngleAxisd(heading, Vector3::UnitZ());
    start.v_B = start.q_WB.conjugate() * v_W;
    EXPECT_TRUE(dynamics.set_state(start));
    run(dynamics, 12.0);
    EXPECT_LT(dynamics.truth().body.v_B.norm(), 1e-3);
    return (dynamics.truth().body.p_W - start.p_W).norm();
  };
  const double g = 9.80665;
  const double kStick = 0.03;  // an anchored wheel gives a little
  EXPECT_NEAR(slide({0, 3, 0}, 0.5 * std::numbers::pi), 9.0 / (2 * 0.05 * g), 0.01 * 9.2 + kStick);
  EXPECT_NEAR(slide({0, 1, 0}, 0.0), 1.0 / (2 * 0.6 * g), kStick);
}

}  // namespace
}  // namespace rosflight::sim::test
