// SPDX-License-Identifier: BSD-3-Clause
// Inflow, flapping and centre of mass: what a vehicle file switches on besides the default physics.
#include "sim/multirotor/inflow.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/multirotor/multirotor.hpp"
#include "sim/test/world.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kPi = 3.141592653589793;
constexpr double kDiameter_m = 0.381;
constexpr double kDisc_m2 = 0.25 * kPi * kDiameter_m * kDiameter_m;
constexpr double kDensity = 1.225;
constexpr double kCt0 = 0.08729101;
constexpr double kCt1 = -0.11006411;
constexpr double kSpeed_rad_s = 400.0;

std::vector<std::string> bench(std::vector<std::string> more = {}) {
  for (const char* option :
       {"battery.model=constant", "battery.constant_voltage_V=24", "ground.model=none",
        "environment.atmosphere.model=constant", "environment.atmosphere.density_kg_m3=1.225",
        "aero.drag_area_m2=[0, 0, 0]", "aero.rotor_drag_s_m=0"}) {
    more.emplace_back(option);
  }
  return more;
}

/// Forces of four rotors at kSpeed_rad_s in air that comes from ahead and above.
Wrench wrench_of(const std::vector<std::string>& options, double forward_m_s, double climb_m_s) {
  const World world(bench(options));
  BodyState body;
  body.v_B = {forward_m_s, 0.0, -climb_m_s};
  Air air;
  air.density_kg_m3 = kDensity;
  const std::vector<double> x{kSpeed_rad_s, kSpeed_rad_s, kSpeed_rad_s, kSpeed_rad_s, 1e4};
  return evaluate(world.forces, {}, x, body, 1000.0, air).wrench;
}

double thrust_of(const std::vector<std::string>& options, double forward_m_s, double climb_m_s) {
  return -wrench_of(options, forward_m_s, climb_m_s).force_B.z() / 4.0;
}

const std::vector<std::string> kMomentum{"rotors.inflow=momentum"};

double forward(double along, double across) {
  const Lanes axial = axial_inflow(along, 1.0);
  return forward_inflow(along, across * across, 1.0, 0.0, axial)[2];
}

TEST(Inflow, OfAxialFlightHasItsClosedForm) {
  // V = v_h: the smaller golden ratio.
  EXPECT_NEAR(axial_inflow(1.0, 1.0)[0], 0.6180339887498949, 1e-15);
  EXPECT_NEAR(axial_inflow(0.0, 4.0)[1], 2.0, 1e-15);
}

// Glauert's equation without climb: v^4 + v'^2 v^2 = v_h^4.
TEST(Inflow, OfLevelFlightHasItsClosedForm) {
  EXPECT_NEAR(forward(0.0, 1.0), std::sqrt(0.5 * (std::sqrt(5.0) - 1.0)), 1e-9);  // 0.786
  for (const double across : {0.0, 0.1, 0.5, 2.0, 5.0, 20.0}) {
    const double squared =
        0.5 * (std::sqrt(across * across * across * across + 4.0) - across * across);
    EXPECT_NEAR(forward(0.0, across), std::sqrt(squared), 1e-9) << across;
  }
  // Fast, a rotor is a wing: v = v_h^2/v'.
  EXPECT_NEAR(forward(0.0, 20.0), 0.05, 1e-6);
}

TEST(Inflow, OfAClimbAcrossTheAirSolvesGlauertsEquation) {
  for (const double along : {0.0, 0.3, 2.0}) {
    for (const double across : {0.2, 1.0, 4.0}) {
      const double v = forward(along, across);
      EXPECT_NEAR(v * std::sqrt(across * across + (along + v) * (along + v)), 1.0, 1e-9);
    }
  }
}

// The thrust that blade elements and momentum theory agree on in a slow climb falls as C_T(J) says.
TEST(Inflow, LiftSlopeGivesThePropellersOwnThrustInAClimb) {
  const double a = lift_slope_m3(kDiameter_m, kCt0, kCt1);
  const double hover_thrust_N =
      kCt0 * kDensity * std::pow(kDiameter_m, 4) / (4.0 * kPi * kPi) * kSpeed_rad_s * kSpeed_rad_s;
  const double v_h = std::sqrt(hover_thrust_N / (2.0 * kDensity * kDisc_m2));
  constexpr double kClimb_m_s = 1e-3;
  double thrust_N = hover_thrust_N;
  for (int i = 0; i < 200; ++i) {
    const double v = axial_inflow(kClimb_m_s, thrust_N / (2.0 * kDensity * kDisc_m2))[0];
    thrust_N = hover_thrust_N - kDensity * a * kSpeed_rad_s * (kClimb_m_s + v - v_h);
  }
  const double u = 2.0 * kPi * kClimb_m_s / kDiameter_m;
  const double lost_thrust_N =
      -kCt1 * kDensity * std::pow(kDiameter_m, 4) / (4.0 * kPi * kPi) * kSpeed_rad_s * u;
  EXPECT_NEAR((hover_thrust_N - thrust_N) / lost_thrust_N, 1.0, 1e-3);
}

TEST(Inflow, OfMomentumChangesNothingInAxialFlight) {
  for (const double climb : {0.0, 1.0, 5.0}) {
    EXPECT_NEAR(thrust_of(kMomentum, 0.0, climb), thrust_of({}, 0.0, climb), 1e-9) << climb;
  }
}

TEST(Inflow, InForwardFlightThrustAndInducedVelocityAgree) {
  const double a = lift_slope_m3(kDiameter_m, kCt0, kCt1);
  const double axial_thrust_N = thrust_of({}, 0.0, 0.0);
  const double v_axial = std::sqrt(axial_thrust_N / (2.0 * kDensity * kDisc_m2));
  double before_thrust_N = axial_thrust_N;
  for (const double speed : {2.0, 5.0, 10.0, 15.0}) {
    const double thrust_N = thrust_of(kMomentum, speed, 0.0);
    EXPECT_GT(thrust_N, before_thrust_N) << "translational lift at " << speed;
    before_thrust_N = thrust_N;
    // What the thrust says of the induced velocity solves momentum theory for that thrust.
    const double v = v_axial - (thrust_N - axial_thrust_N) / (kDensity * a * kSpeed_rad_s);
    EXPECT_NEAR(2.0 * kDensity * kDisc_m2 * v * std::sqrt(speed * speed + v * v), thrust_N, 1e-7);
  }
  EXPECT_EQ(thrust_of({}, 10.0, 0.0), axial_thrust_N)
      << "without it, air across a rotor does nothing";
}

// Ideal power in level flight is T v: as the thrust needs less of it the torque falls.
TEST(Inflow, InForwardFlightTheInducedPowerFalls) {
  const auto torque = [](const std::vector<std::string>& options, double speed) {
    const World world(bench(options));
    BodyState body;
    body.v_B = {speed, 0.0, 0.0};
    Air air;
    air.density_kg_m3 = kDensity;
    std::vector<double> x{0.0, 0.0, 0.0, 0.0, 1e4};
    x[1] = kSpeed_rad_s;
    const Evaluation e = evaluate(world.forces, {}, x, body, 1000.0, air);
    // The rotor runs free: its torque is what slows it down, but for the motor's friction.
    return -3.8e-4 * e.rate[1] - 0.028937 * 1.5;
  };
  const double axial_thrust_N = thrust_of({}, 0.0, 0.0);
  const double v_axial = std::sqrt(axial_thrust_N / (2.0 * kDensity * kDisc_m2));
  const double a = lift_slope_m3(kDiameter_m, kCt0, kCt1);
  const double thrust_N = thrust_of(kMomentum, 10.0, 0.0);
  const double v = v_axial - (thrust_N - axial_thrust_N) / (kDensity * a * kSpeed_rad_s);
  const double saved_Nm = (axial_thrust_N * v_axial - thrust_N * v) / kSpeed_rad_s;
  EXPECT_GT(saved_Nm, 0.01);
  EXPECT_NEAR(torque({}, 10.0) - torque(kMomentum, 10.0), saved_Nm, 1e-9);
}

TEST(Inflow, IsRefusedWhereItHasNoMeaning) {
  for (const char* option : {"rotors.motor.model=first_order", "rotors.flow=reference",
                             "rotors.propeller.thrust_coefficients=[0.08, 0, -0.1]"}) {
    EXPECT_THROW(
        World(bench({"rotors.inflow=momentum", "rotors.motor.time_constant_s=0.05", option})),
        config::Error)
        << option;
  }
}

// Pounds, Mahony, Corke 2010: a1 = mu (4 theta_t - 2 lambda)/(1 - mu^2/2), by hand for a 15 x 5.5 inch
// propeller at 400 rad/s and 8 m/s: tip speed 76.2 m/s, mu 0.10499, tip pitch 6.655 degrees.
TEST(Flapping, TiltsTheThrustAgainstTheAir) {
  const std::vector<std::string> options{
      "rotors.propeller.flapping={tip_pitch_deg: 6.655, hub_stiffness_Nm_rad: 2}"};
  const Wrench still = wrench_of(options, 0.0, 0.0);
  const Wrench wrench = wrench_of(options, 8.0, 0.0);
  const double thrust_N = -still.force_B.z() / 4.0;
  const double lambda = std::sqrt(thrust_N / (2.0 * kDensity * kDisc_m2)) / 76.2;
  const double mu = 8.0 / 76.2;
  const double a1 = mu * (4.0 * 6.655 * kPi / 180.0 - 2.0 * lambda) / (1.0 - 0.5 * mu * mu);
  EXPECT_NEAR(a1, 0.0332, 1e-4);
  EXPECT_NEAR(wrench.force_B.x(), -4.0 * thrust_N * a1, 1e-9);
  EXPECT_EQ(wrench.force_B.z(), still.force_B.z());
  // The force acts 76.2 mm above the centre of mass, and the stiff hubs raise the nose: both pitch up.
  EXPECT_NEAR(wrench.torque_B.y() - still.torque_B.y(), 4.0 * (0.0762 * thrust_N * a1 + 2.0 * a1),
              1e-9);
  EXPECT_NEAR(still.force_B.x(), 0.0, 1e-12);
}

TEST(Flapping, NeedsARotorThatTurns) {
  const World world(
      bench({"rotors.propeller.flapping={tip_pitch_deg: 6.655, hub_stiffness_Nm_rad: 2}"}));
  BodyState body;
  body.v_B = {10.0, 0.0, 0.0};
  const std::vector<double> x{0.0, 0.0, 0.0, 0.0, 1e4};
  const Wrench parked = evaluate(world.forces, {}, x, body).wrench;
  EXPECT_EQ(parked.torque_B.y(), 0.0);
  EXPECT_EQ(parked.force_B.x(), 0.0);
}

TEST(CentreOfMass, OffTheMiddleTheRotorsTurnTheVehicle) {
  const std::vector<std::string> options{"body.center_of_mass_m=[0.02, -0.01, 0.03]"};
  const Wrench wrench = wrench_of(options, 0.0, 0.0);
  const Wrench centred = wrench_of({}, 0.0, 0.0);
  EXPECT_EQ(wrench.force_B.z(), centred.force_B.z());
  // A mass that lies forward and left falls forward and left: the moment of the thrust is c x T.
  const double lift_N = -wrench.force_B.z();
  EXPECT_NEAR(wrench.torque_B.y() - centred.torque_B.y(), -0.02 * lift_N, 1e-9);
  EXPECT_NEAR(wrench.torque_B.x() - centred.torque_B.x(), -0.01 * lift_N, 1e-9);
}

TEST(CentreOfMass, TheDragActsInTheMiddleOfTheAirframe) {
  const World world({"body.center_of_mass_m=[0, 0, 0.1]", "aero.rotor_drag_s_m=0"});
  BodyState body;
  body.v_B = {10.0, 0.0, 0.0};
  Air air;
  air.density_kg_m3 = kDensity;
  std::vector<double> x(5, 0.0);
  const Wrench wrench = evaluate(world.forces, {}, x, body, 1000.0, air).wrench;
  const double drag_N = 0.5 * kDensity * 100.0 * 0.082;
  EXPECT_NEAR(wrench.force_B.x(), -drag_N, 1e-9);
  EXPECT_NEAR(wrench.torque_B.y(), 0.1 * drag_N, 1e-9) << "above the mass: the nose goes up";
}

TEST(CentreOfMass, MovesContactsToo) {
  const Vehicle vehicle =
      Vehicle::from_file(kVehicleFile, {"body.center_of_mass_m=[0.02, 0, 0.05]"});
  EXPECT_NEAR(vehicle.ground().contacts_B[0].x(), 0.13, 1e-12);
  EXPECT_NEAR(vehicle.ground().contacts_B[0].z(), 0.15, 1e-12);
  World world({"body.center_of_mass_m=[0.02, 0, 0.05]"});
  world.run(2.0, {});
  EXPECT_LT(world.dynamics.truth().body.v_B.norm(), 1e-3);
  // Feet 0.13 m ahead and 0.17 m behind, 5.05 mm deep on average: the load tips it onto the front ones.
  EXPECT_NEAR(-world.dynamics.truth().body.p_W.z(), 0.15 - 3.5 * 9.80665 / (4 * 1700.0), 5e-4);
}

}  // namespace
}  // namespace rosflight::sim::test
