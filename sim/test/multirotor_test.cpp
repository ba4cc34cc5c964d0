// SPDX-License-Identifier: BSD-3-Clause
#include "sim/multirotor/multirotor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kPi = 3.141592653589793;

std::vector<double> states(double speed_rad_s, double charge_As) {
  return {speed_rad_s, speed_rad_s, speed_rad_s, speed_rad_s, charge_As};
}

// ---- With the options of ROSflight 2.x: its derived check values, to the digits they are given
// with. ----

TEST(MultirotorReference, StaticTable) {
  const World world(reference_options());
  struct Row {
    double throttle, thrust_N, torque_Nm, speed_rad_s;
  };
  for (const Row& row : {Row{0.10, 0.3691, 0.0069, 80.42}, Row{0.30, 3.3831, 0.0633, 243.46},
                         Row{0.50, 9.3057, 0.1741, 403.79}, Row{0.70, 17.9953, 0.3366, 561.51},
                         Row{1.00, 35.9361, 0.6723, 793.49}}) {
    // One motor alone, so that its torques can be distinguished; the command is a float: 3e-8
    // relative.
    hal::OutputValues outputs{};
    outputs[0] = static_cast<float>(row.throttle);
    const Evaluation e = evaluate(world.forces, outputs, initial_states(world.forces));
    EXPECT_NEAR(-e.wrench.force_B.z(), row.thrust_N, 6e-5) << row.throttle;
    EXPECT_NEAR(e.wrench.torque_B.z(), row.torque_Nm, 6e-5) << row.throttle;
    EXPECT_NEAR(e.truth.rotor_speed_rad_s[0], row.speed_rad_s, 6e-3) << row.throttle;
    EXPECT_NEAR(e.wrench.torque_B.x(), -row.thrust_N * 0.25 * std::sin(kPi / 4), 2e-5)
        << row.throttle;
    EXPECT_NEAR(e.wrench.torque_B.y(), row.thrust_N * 0.25 * std::cos(kPi / 4), 2e-5)
        << row.throttle;
  }
}

TEST(MultirotorReference, HoverPoint) {
  const World world(reference_options());
  const Evaluation e = evaluate(world.forces, all_motors(0.479918), initial_states(world.forces));
  EXPECT_NEAR(-e.wrench.force_B.z() / 4.0, 8.58375,
              2e-5);  // thrust slope 38 N per unit throttle times 5e-7
  EXPECT_NEAR(-e.wrench.force_B.z(), 3.5 * 9.81, 8e-5);
  EXPECT_NEAR(e.truth.rotor_speed_rad_s[2], 387.807, 5e-4);
  hal::OutputValues one{};
  one[1] = 0.479918F;
  EXPECT_NEAR(evaluate(world.forces, one, initial_states(world.forces)).wrench.torque_B.z(),
              -0.160575, 1e-6);
}

TEST(MultirotorReference, RotorsStartToTurnAtTheirThreshold) {
  const World world(reference_options());
  // I0 R / V = 1.5 * 0.042 / 24 = 0.002625.
  const auto speed = [&](double throttle) {
    return evaluate(world.forces, all_motors(throttle), initial_states(world.forces))
        .truth.rotor_speed_rad_s[0];
  };
  EXPECT_EQ(speed(0.00262), 1e-4);
  EXPECT_GT(speed(0.00263), 1e-3);
}

TEST(MultirotorReference, FullThrottleClimb) {
  const World world(reference_options());
  BodyState climb;
  climb.v_B = {0.0, 0.0, -5.0};
  const Evaluation e = evaluate(world.forces, all_motors(1.0), initial_states(world.forces), climb);
  const double drag_N = 0.5 * 1.225 * 0.082 * 25.0;
  EXPECT_NEAR((-e.wrench.force_B.z() + drag_N) / 4.0, 30.655, 6e-4);
  EXPECT_NEAR(2.0 * kPi * 5.0 / (e.truth.rotor_speed_rad_s[0] * 0.381), 0.1039, 6e-5);
}

TEST(MultirotorReference, GroundEffectPolynomial) {
  const World world(reference_options());
  const auto lift = [&](double height) {
    return -evaluate(world.forces, {}, initial_states(world.forces), {}, height).wrench.force_B.z();
  };
  EXPECT_NEAR(lift(0.35), 4.2, 0.05);  // its maximum
  EXPECT_GT(lift(0.122), 0.0);
  EXPECT_LT(lift(0.120), 1e-6);
  EXPECT_GT(lift(1.296), 0.0);
  EXPECT_LT(lift(1.298), 1e-6);
}

TEST(MultirotorReference, DragIsBodyAndRotorDrag) {
  const World world(reference_options());
  BodyState forward;
  forward.v_B = {4.0, -3.0, 0.0};
  const Evaluation e =
      evaluate(world.forces, all_motors(0.479918), initial_states(world.forces), forward);
  const double body = 0.5 * 1.225 * 0.082 * 5.0;
  const double rotor = 0.05 * 4.0 * 8.58375;
  EXPECT_NEAR(e.wrench.force_B.x(), -4.0 * (body + rotor), 1e-5);
  EXPECT_NEAR(e.wrench.force_B.y(), 3.0 * (body + rotor), 1e-5);
}

TEST(MultirotorReference, WindIsSubtracted) {
  const World world(reference_options());
  Air air;
  air.wind_W = {4.0, -3.0, 0.0};
  BodyState carried;
  carried.v_B = {4.0, -3.0, 0.0};
  const Evaluation e = evaluate(world.forces, all_motors(0.479918), initial_states(world.forces),
                                carried, 1000.0, air);
  EXPECT_NEAR(e.wrench.force_B.head<2>().norm(), 0.0, 1e-12);
}

// ---- The better physics. ----

/// A test bench: constant voltage, sea level, no ground, a mass that hardly moves.
std::vector<std::string> with(std::vector<std::string> more = {}) {
  for (const char* option :
       {"battery.model=constant", "battery.constant_voltage_V=24", "ground.model=none",
        "body.mass_kg=100000", "environment.atmosphere.model=constant",
        "environment.atmosphere.density_kg_m3=1.225"}) {
    more.emplace_back(option);
  }
  return more;
}

TEST(Multirotor, RotorSpeedEndsWhereTheReferenceFormulaSays) {
  // Constant 24 V, sea level: the steady state of the dynamic rotor is the table's.
  World world(with({"environment.gravity_m_s2=0"}));
  world.run(1.0, all_motors(0.5));
  const Truth& truth = world.dynamics.truth();
  EXPECT_NEAR(truth.rotor_speed_rad_s[0], 403.79, 6e-3);
  EXPECT_NEAR(-truth.wrench.force_B.z() / 4.0, 9.3057, 4e-4);  // climbs at 0.4 mm/s by then
}

const char* const kTiltingRotor =
    "rotors.layout.2.tilt={output: 8, axis: [-1, 0, 0], travel_deg: 30, time_constant_s: 0.03, "
    "rate_limit_deg_s: 500}";

TEST(Multirotor, ATiltedRotorPushesAndTurnsAboutItsTurnedAxis) {
  const World world(with({kTiltingRotor}));
  ASSERT_EQ(world.forces.state_size(), 6U);
  std::vector<double> x(6, 0.0);
  x[2] = 400.0;
  x[4] = 1000.0;
  const Wrench upright = evaluate(world.forces, {}, x).wrench;
  const double thrust_N = -upright.force_B.z();
  const double spin = -1.0;
  const double drag_Nm = -spin * (upright.torque_B.z());
  x[5] = 0.3;
  const Wrench tilted = evaluate(world.forces, {}, x).wrench;
  // The direction (0, 0, -1) turned by 0.3 rad about -x.
  const Vector3 e(0.0, -std::sin(0.3), -std::cos(0.3));
  const Vector3 p(-0.1768, -0.1768, -0.0762);
  EXPECT_NEAR((tilted.force_B - thrust_N * e).norm(), 0.0, 1e-12);
  EXPECT_NEAR((tilted.torque_B - (thrust_N * p.cross(e) + spin * drag_Nm * e)).norm(), 0.0, 1e-12);
}

TEST(Multirotor, ATiltServoHasLagAndALimitOfItsRate) {
  World world(with({kTiltingRotor, "environment.gravity_m_s2=0"}));
  const double travel = 30.0 * kPi / 180.0;
  const double limit = 500.0 * kPi / 180.0;
  hal::OutputValues outputs{};
  outputs[8] = 1.0F;
  // At its limit until the lag asks for less: at travel - limit tau.
  const double until_s = (travel - limit * 0.03) / limit;
  world.run(until_s, outputs);
  EXPECT_NEAR(world.dynamics.module_state()[5], limit * until_s, 1e-6);
  world.run(0.03, outputs);
  EXPECT_NEAR(world.dynamics.module_state()[5], travel - limit * 0.03 * std::exp(-1.0), 1e-5);
  outputs[8] = std::numeric_limits<float>::quiet_NaN();
  const double before = world.dynamics.module_state()[5];
  world.run(0.1, outputs);
  EXPECT_EQ(world.dynamics.module_state()[5], before) << "a servo without a command stays";
  world.forces.set_surface_stuck(0, true);
  outputs[8] = 0.0F;
  world.run(0.1, outputs);
  EXPECT_EQ(world.dynamics.module_state()[5], before) << "a stuck one too";
}

TEST(Multirotor, AnOutputDrivesOneThing) {
  try {
    const World world(
        {"rotors.layout.2.tilt={output: 1, axis: [1, 0, 0], travel_deg: 30, "
         "time_constant_s: 0.03, rate_limit_deg_s: 500}"});
    FAIL();
  } catch (const config::Error& error) {
    EXPECT_NE(std::string(error.what()).find("found 1 again, allowed each output once"),
              std::string::npos)
        << error.what();
  }
}

TEST(Multirotor, StepResponseHasTheLinearTimeConstant) {
  World world(with({"environment.gravity_m_s2=0"}));
  world.run(1.0, all_motors(0.48));
  const double before = world.dynamics.truth().rotor_speed_rad_s[0];
  world.run(1.0, all_motors(0.481));
  const double after = world.dynamics.truth().rotor_speed_rad_s[0];
  // tau = J / (K^2/R + 2 kQ O), linearised between the two speeds.
  const double k_q = 0.00428594 * 1.225 * std::pow(0.381, 5) / (4.0 * kPi * kPi);
  const double tau = 3.8e-4 / (0.028937 * 0.028937 / 0.042 + 2.0 * k_q * 0.5 * (before + after));
  World step({"battery.model=constant", "battery.constant_voltage_V=24", "ground.model=none",
              "environment.atmosphere.model=constant", "environment.atmosphere.density_kg_m3=1.225",
              "environment.gravity_m_s2=0", "body.mass_kg=100000"});
  step.run(1.0, all_motors(0.48));
  step.run(0.02, all_motors(0.481));
  const double now = step.dynamics.truth().rotor_speed_rad_s[0];
  EXPECT_NEAR((after - now) / (after - before), std::exp(-0.02 / tau), 1e-3);
  EXPECT_NEAR(tau, 0.0183, 2e-4);
}

TEST(Multirotor, FirstOrderModelFollowsItsTimeConstant) {
  World world(with({"environment.gravity_m_s2=0", "rotors.motor.model=first_order",
                    "rotors.motor.time_constant_s=0.05"}));
  world.run(0.05, all_motors(0.5));
  EXPECT_NEAR(world.dynamics.truth().rotor_speed_rad_s[3] / 403.79, 1.0 - std::exp(-1.0), 1e-4);
}

TEST(Multirotor, DisarmedRotorsRunDownFreely) {
  World world(with({"environment.gravity_m_s2=0"}));
  const double density = 1.225;
  world.run(1.0, all_motors(0.4));
  const double start = world.dynamics.truth().rotor_speed_rad_s[0];
  world.run(0.1, all_motors(0.0));
  EXPECT_EQ(world.dynamics.truth().battery_current_A, 0.8);  // the avionics alone
  // J dO/dt = -K I0 - kQ O^2 integrates to an arc tangent.
  const double friction = 0.028937 * 1.5;
  const double k_q = 0.00428594 * density * std::pow(0.381, 5) / (4.0 * kPi * kPi);
  const double root = std::sqrt(k_q / friction);
  const double expected =
      std::tan(std::atan(start * root) - 0.1 * std::sqrt(k_q * friction) / 3.8e-4) / root;
  EXPECT_NEAR(world.dynamics.truth().rotor_speed_rad_s[0], expected, 1e-3);
  world.run(10.0, all_motors(0.0));
  EXPECT_EQ(world.dynamics.truth().rotor_speed_rad_s[0], 0.0);
}

TEST(Multirotor, AngularMomentumOfBodyAndRotorsIsConserved) {
  // No air: motors spin rotors up against the body alone. H = J w - sum spin J_r O e in W stays
  // zero, whatever the gyroscopic and acceleration torques do; one rotor is tilted so that all axes
  // take part.
  World world({"ground.model=none", "environment.gravity_m_s2=0",
               "environment.atmosphere.model=constant",
               "environment.atmosphere.density_kg_m3=1e-12",
               "rotors.layout.0.thrust_direction=[0.6, 0, -0.8]"});
  hal::OutputValues outputs{};
  outputs[0] = 0.3F;
  outputs[1] = 0.2F;
  world.run(0.5, outputs);
  const Truth& truth = world.dynamics.truth();
  const auto momentum = [&](const Truth& t) {
    Vector3 h = world.vehicle.body().inertia_kg_m2 * t.body.w_B;
    const Vector3 axis[4] = {
        {0.6, 0.0, -0.8}, {0.0, 0.0, -1.0}, {0.0, 0.0, -1.0}, {0.0, 0.0, -1.0}};
    const double spin[4] = {-1.0, 1.0, -1.0, 1.0};
    for (std::size_t i = 0; i < 4; ++i) h -= spin[i] * 3.8e-4 * t.rotor_speed_rad_s[i] * axis[i];
    return Vector3(t.body.q_WB * h);
  };
  EXPECT_GT(truth.rotor_speed_rad_s[0], 200.0);
  EXPECT_GT(truth.body.w_B.norm(), 0.5);
  EXPECT_LT(momentum(truth).norm(), 1e-6);  // of 0.1 N m s in each rotor
  const double driven = truth.rotor_speed_rad_s[0];
  world.run(0.5, all_motors(0.0));
  EXPECT_LT(world.dynamics.truth().rotor_speed_rad_s[0], driven - 20.0);
  EXPECT_LT(momentum(world.dynamics.truth()).norm(), 1e-6);
}

TEST(Multirotor, TiltedRotorsPushAlongTheirAxis) {
  const World world({"rotors.layout.0.thrust_direction=[0.6, 0, -0.8]", "battery.model=constant",
                     "battery.constant_voltage_V=24"});
  hal::OutputValues outputs{};
  auto x = states(0.0, 1.0);
  x[0] = 403.79;
  const Evaluation e = evaluate(world.forces, outputs, x);
  const double thrust = 9.3057;
  EXPECT_NEAR(e.wrench.force_B.x(), 0.6 * thrust, 3e-4);
  EXPECT_NEAR(e.wrench.force_B.z(), -0.8 * thrust, 3e-4);
  const Vector3 arm(0.1768, 0.1768, -0.0762);
  // Free wheel: all of Q is taken up by the rotor's own slowing down but for the bearing friction K
  // I0.
  const Vector3 expected =
      arm.cross(e.wrench.force_B) + 1.0 * 0.028937 * 1.5 * Vector3(0.6, 0.0, -0.8);
  EXPECT_LT((e.wrench.torque_B - expected).norm(), 1e-4);
}

TEST(Multirotor, HoverThrottleCarriesTheWeight) {
  // Standard air at 1387 m: solve for the duty with the battery's sag by hand, see that nothing
  // moves.
  World world({"ground.model=none", "aero.ground_effect=none"});
  const double density = world.dynamics.truth().air.density_kg_m3;
  const double d = 0.381;
  const double weight = 3.5 * 9.80665;
  const double speed =
      std::sqrt(weight / 4.0 * 4.0 * kPi * kPi / (0.08729101 * density * std::pow(d, 4)));
  const double torque = 0.00428594 * density * std::pow(d, 5) / (4.0 * kPi * kPi) * speed * speed;
  const double current = torque / 0.028937 + 1.5;
  const double motor_V = current * 0.042 + 0.028937 * speed;
  double duty = 0.5;
  for (int i = 0; i < 50; ++i) duty = motor_V / (25.2 - 0.02 * (0.8 + 4.0 * duty * current));
  const BodyState still;
  const Evaluation e = evaluate(world.forces, all_motors(duty), states(speed, 8.0 * 3600.0), still,
                                1000.0, {density, 0.0, 0.0, Vector3::Zero()});
  EXPECT_NEAR(-e.wrench.force_B.z(), weight, 1e-6);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(e.rate[i], 0.0, 2e-3);  // duty is a float: 3e-8 of 4.5e4 rad/s^2
  EXPECT_NEAR(e.truth.battery_current_A, 0.8 + 4.0 * duty * current, 1e-4);
  EXPECT_NEAR(e.truth.battery_voltage_V, 25.2 - 0.02 * (0.8 + 4.0 * duty * current), 1e-5);
}

TEST(Multirotor, BatteryChargeIsConserved) {
  World world({"battery.capacity_Ah=0.2", "ground.model=none"});
  double drawn_As = 0.0;
  double previous_A = world.dynamics.truth().battery_current_A;
  for (int i = 0; i < 12'000; ++i) {
    world.run(0.0025, all_motors(i % 400 < 200 ? 0.4 : 0.5));
    const double now_A = world.dynamics.truth().battery_current_A;
    drawn_As += 0.5 * (previous_A + now_A) * 0.0025;
    previous_A = now_A;
  }
  const double left_As = world.dynamics.module_state()[4];
  EXPECT_LT(left_As, 0.8 * 720.0);
  // The trapezoid misses the peaks at 150 switches, each a step of tens of A over at most one step
  // of 2.5 ms.
  EXPECT_NEAR(720.0 - left_As, drawn_As, 0.01 * drawn_As);
}

TEST(Multirotor, EmptyBatteryStopsTheMotors) {
  World world({"battery.capacity_Ah=0.02", "ground.model=none"});
  world.run(30.0, all_motors(0.5));
  const Truth& truth = world.dynamics.truth();
  EXPECT_EQ(world.dynamics.module_state()[4], 0.0);
  EXPECT_EQ(truth.battery_voltage_V, 0.0);
  EXPECT_EQ(truth.battery_current_A, 0.0);
}

TEST(Multirotor, ALimitedChargeIsNoMoreThanItsShare) {
  World world({"ground.model=none"});
  world.forces.set_charge_limit(0.15);
  world.run(0.1, all_motors(0.0));
  const double capacity_As = 8.0 * 3600.0;
  EXPECT_NEAR(world.dynamics.module_state()[4], 0.15 * capacity_As, 1.0);
  EXPECT_NEAR(world.dynamics.truth().battery_voltage_V, 6 * 3.71 - 0.016, 1e-3);
}

TEST(Multirotor, VoltageFollowsTheCurveOfTheCells) {
  World world({"ground.model=none"});
  const auto voltage = [&](double charge) {
    return evaluate(world.forces, {}, states(0.0, charge * 8.0 * 3600.0)).truth.battery_voltage_V;
  };
  EXPECT_NEAR(voltage(1.0), 6 * 4.20 - 0.016, 1e-9);
  EXPECT_NEAR(voltage(0.5), 6 * 3.84 - 0.016, 1e-9);
  EXPECT_NEAR(voltage(0.525), 6 * 3.845 - 0.016, 1e-9);
}

TEST(Multirotor, GroundEffectIsCheesemanBennett) {
  const World world({"battery.model=constant", "battery.constant_voltage_V=24"});
  const auto thrust = [&](double height) {
    return -evaluate(world.forces, {}, states(400.0, 1.0), {}, height).wrench.force_B.z();
  };
  const double radius = 0.1905;
  const double hub = 1.0 * radius;  // one radius over ground
  EXPECT_NEAR(thrust(hub - 0.0762) / thrust(1000.0), 1.0 / (1.0 - 1.0 / 16.0), 1e-12);
  EXPECT_NEAR(thrust(0.0) / thrust(1000.0), 1.0 / (1.0 - 0.25), 1e-12);  // held below half a radius
}

TEST(Multirotor, ThrustIsSmoothThroughHoverAndBoundedInDescent) {
  const World world(
      {"battery.model=constant", "battery.constant_voltage_V=24", "aero.drag_area_m2=[0, 0, 0]"});
  const auto thrust = [&](double climb_m_s) {
    BodyState body;
    body.v_B.z() = -climb_m_s;
    return -evaluate(world.forces, {}, states(400.0, 1.0), body).wrench.force_B.z();
  };
  const double slope_up = (thrust(0.01) - thrust(0.0)) / 0.01;
  const double slope_down = (thrust(0.0) - thrust(-0.01)) / 0.01;
  EXPECT_LT(slope_up, 0.0);
  EXPECT_NEAR(slope_down / slope_up, 1.0, 1e-3);
  EXPECT_EQ(thrust(-5.0), thrust(-10.0));
  EXPECT_NEAR(thrust(-10.0) / thrust(0.0), 1.0 + 0.11006411 * 0.12 / 0.08729101, 1e-9);
}

TEST(Multirotor, FaultedMotorLosesThrustAndDeadMotorRunsDown) {
  World world(
      with({"environment.gravity_m_s2=0", "body.inertia_kg_m2={xx: 1e5, yy: 1e5, zz: 1e5}"}));
  const double healthy =
      -evaluate(world.forces, all_motors(0.5), states(400.0, 1.0)).wrench.force_B.z();
  world.forces.set_thrust_factor(2, 0.4);
  EXPECT_NEAR(-evaluate(world.forces, all_motors(0.5), states(400.0, 1.0)).wrench.force_B.z(),
              healthy * 3.4 / 4.0, 1e-9);
  world.forces.set_thrust_factor(2, 0.0);
  world.run(10.0, all_motors(0.5));
  EXPECT_LT(world.dynamics.truth().rotor_speed_rad_s[2], 60.0);  // windmilling at most
  EXPECT_GT(world.dynamics.truth().rotor_speed_rad_s[0], 300.0);
  world.forces.set_thrust_factor(2, 1.0);
  world.run(1.0, all_motors(0.5));
  EXPECT_GT(world.dynamics.truth().rotor_speed_rad_s[2], 300.0);
  world.forces.set_thrust_factor(99, 0.5);  // no such rotor: nothing happens
}

TEST(Multirotor, CommandsOutsideZeroToOneAreHarmless) {
  const World world({"battery.model=constant", "battery.constant_voltage_V=24"});
  hal::OutputValues bad{};
  bad[0] = std::numeric_limits<float>::quiet_NaN();
  bad[1] = -3.0F;
  bad[2] = 7.0F;
  bad[3] = std::numeric_limits<float>::infinity();
  const Evaluation e = evaluate(world.forces, bad, states(100.0, 1.0));
  hal::OutputValues good{};
  good[2] = good[3] = 1.0F;
  EXPECT_EQ(e.rate, evaluate(world.forces, good, states(100.0, 1.0)).rate);
}

TEST(Multirotor, BrakingAndCurrentLimitBoundTheMotorCurrent) {
  const World braking({"battery.model=constant", "battery.constant_voltage_V=24"});
  const World coasting({"battery.model=constant", "battery.constant_voltage_V=24",
                        "rotors.motor.active_braking=false"});
  const auto current = [](const World& world, double duty, double speed) {
    return (evaluate(world.forces, all_motors(duty), states(speed, 1.0)).truth.battery_current_A -
            0.8) /
           (4.0 * duty);
  };
  EXPECT_NEAR(current(braking, 0.5, 0.0), 60.0, 1e-5);  // limit; 286 A without
  EXPECT_NEAR(current(braking, 0.1, 700.0), -60.0, 1e-4);
  EXPECT_NEAR(current(coasting, 0.1, 700.0), 0.0, 1e-12);
}

}  // namespace
}  // namespace rosflight::sim::test
