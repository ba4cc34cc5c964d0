// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fixedwing/trim.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "sim/fixedwing/test/hangar.hpp"

namespace rosflight::sim::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Row {
  const char* vehicle;
  double airspeed_m_s;
  double alpha_deg;
  double elevator_deg;
  double thrust_N;
  double throttle;
};

/// Steady level flight of ROSflight 2.x's models, worked out from its equations alone.
constexpr Row kLevelFlight[] = {
    {"anaconda", 12, 4.36, -4.27, 3.76, 0.422},
    {"anaconda", 15, 0.77, 5.68, 4.36, 0.506},
    {"anaconda", 20, -2.04, 13.47, 6.62, 0.664},
    {"anaconda", 25, -3.35, 17.08, 9.99, 0.831},
    {"openvsp_anaconda", 12, 5.73, -7.40, 3.45, 0.419},
    {"openvsp_anaconda", 15, 0.93, -1.86, 3.47, 0.494},
    {"openvsp_anaconda", 20, -2.85, 2.49, 4.72, 0.642},
    {"xflr5_anaconda", 12, 4.44, -2.95, 3.27, 0.415},
    {"xflr5_anaconda", 15, 0.62, -0.30, 3.48, 0.494},
    {"xflr5_anaconda", 20, -2.37, 1.77, 4.74, 0.642},
    {"aerosonde", 20, 5.90, -15.55, 1.61, 0.555},
    {"aerosonde", 25, 2.87, -7.16, 0.95, 0.677},
    {"aerosonde", 35, 0.23, 0.15, 0.65, 0.938},
};

const ReferenceAircraft& reference_aircraft(const std::string& name) {
  for (const ReferenceAircraft& aircraft : kReferenceAircraft)
    if (aircraft.name == name) return aircraft;
  throw std::runtime_error("no vehicle " + name);
}

TEST(Trim, MeetsTheLevelFlightOfTheReference) {
  for (const Row& row : kLevelFlight) {
    SCOPED_TRACE(row.vehicle + std::string(" ") + std::to_string(row.airspeed_m_s));
    const Hangar hangar(reference_aircraft(row.vehicle));
    const Trim trim = hangar.trim(row.airspeed_m_s);
    // Half a unit of the last digit; the table leaves out the aileron against the propeller's
    // torque and its side force.
    EXPECT_NEAR(trim.alpha_rad / kDegree, row.alpha_deg, 0.006);
    EXPECT_NEAR(trim.deflection.elevator_rad / kDegree, row.elevator_deg, 0.012);
    EXPECT_NEAR(trim.thrust_N, row.thrust_N, 0.006);
    EXPECT_NEAR(trim.throttle, row.throttle, 0.0006);
  }
}

TEST(Trim, TheReferencesAnacondaCannotHold30MetresPerSecond) {
  const Hangar hangar(reference_aircraft("anaconda"));
  try {
    hangar.trim(30.0);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "needs more than full throttle");
  }
}

TEST(Trim, BelowTheStallThereIsNone) {
  const Hangar hangar("anaconda");
  EXPECT_NO_THROW(hangar.trim(13.0));
  EXPECT_THROW(hangar.trim(8.0), std::runtime_error);
}

TEST(Trim, IsFoundOverTheWholeSpeedRange) {
  const Hangar hangar("anaconda");
  double last_throttle = 0.0;
  for (double speed = 13.0; speed <= 31.0; speed += 0.5) {
    SCOPED_TRACE(speed);
    Trim trim;
    ASSERT_NO_THROW(trim = hangar.trim(speed));
    EXPECT_GT(trim.throttle, last_throttle);  // beyond the speed of least power
    last_throttle = trim.throttle;
    ASSERT_NO_THROW(hangar.trim({speed, -4.0 * kDegree, 0.0, 0.0}));
    if (speed < 16.0) continue;
    ASSERT_NO_THROW(hangar.trim({speed, 0.0, -speed * speed / 8.0, 0.0}));
  }
}

TEST(Trim, StaysWhereItIsInTheSimulator) {
  for (const ReferenceAircraft& aircraft : kReferenceAircraft) {
    SCOPED_TRACE(aircraft.name);
    Hangar hangar(aircraft.name,
                  {"environment.atmosphere.model=constant",
                   "environment.atmosphere.density_kg_m3=1.1", "battery.model=constant",
                   "battery.constant_voltage_V=" + std::to_string(aircraft.voltage_V)});
    const Trim trim = hangar.trim({18.0, 0.05, 0.0, 100.0});
    EXPECT_LT(trim.acceleration_B.norm(), 3e-5);
    EXPECT_LT(trim.angular_acceleration_B.norm(), 3e-5);
    ASSERT_TRUE(hangar.dynamics.set_state(trim.body, trim.module_state));
    for (int i = 1; i <= 800; ++i)
      hangar.dynamics.step(hal::microseconds(2500 * i), trim.outputs);  // 2 s
    const BodyState& now = hangar.dynamics.truth().body;
    EXPECT_NEAR(now.v_B.norm(), 18.0, 2e-3);
    EXPECT_NEAR((now.q_WB * now.v_B).z(), -18.0 * std::sin(0.05), 2e-3);
    EXPECT_NEAR(now.q_WB.angularDistance(trim.body.q_WB), 0.0, 1e-3);
  }
}

TEST(Trim, ATurnHasTheBankOfTheCoordinatedTurn) {
  const Hangar hangar("anaconda");
  const double speed = 17.0;
  const double radius = 60.0;
  const Trim right = hangar.trim({speed, 0.0, radius, 0.0});
  const Trim left = hangar.trim({speed, 0.0, -radius, 0.0});
  const double bank = std::atan(speed * speed / (9.80665 * radius));
  // Zero side slip is not zero side force, and thrust has a part of the lift.
  EXPECT_NEAR(right.roll_rad, bank, 0.05 * bank);
  EXPECT_NEAR(left.roll_rad, -bank, 0.05 * bank);
  EXPECT_GT(right.alpha_rad, hangar.trim(speed).alpha_rad);
  const Vector3 turn = right.body.q_WB * right.body.w_B;
  EXPECT_NEAR(turn.z(), speed / radius, 1e-9);
}

TEST(Trim, AClimbTakesTheWeightsPartMoreOfThrust) {
  const Hangar hangar("anaconda");
  const Trim level = hangar.trim({15.0, 0.0, 0.0, 0.0});
  const Trim climb = hangar.trim({15.0, 0.1, 0.0, 0.0});
  // Less lift is needed and so less of the drag it induces: 2 %.
  EXPECT_NEAR(climb.thrust_N - level.thrust_N, 4.5 * 9.80665 * std::sin(0.1), 0.1);
}

std::map<std::string, Mode> modes_of(const Hangar& hangar, double speed) {
  std::map<std::string, Mode> all;
  for (const Mode& mode : find_modes(hangar.trimmed(), hangar.trim(speed)))
    all.emplace(mode.name, mode);
  return all;
}

TEST(Modes, EachAircraftHasTheFiveOfTheTextbookAndItsMotors) {
  for (const ReferenceAircraft& aircraft : kReferenceAircraft) {
    SCOPED_TRACE(aircraft.name);
    const auto modes = modes_of(Hangar(aircraft.name), 18.0);
    for (const char* name : {"short period", "phugoid", "Dutch roll", "roll", "spiral", "motor"})
      EXPECT_TRUE(modes.contains(name)) << name;
    EXPECT_EQ(modes.size(), 6U);
  }
}

TEST(Modes, AnAircraftThatHoldsItsAngleOfAttackHasLanchestersPhugoid) {
  // His assumption: stiff in pitch, without damping there.
  const Hangar hangar("anaconda",
                      {"aero.pitch.alpha=-100", "aero.pitch.zero=-1.95", "aero.lift.q=0"});
  const Trim trim = hangar.trim(20.0);
  const auto modes = modes_of(hangar, 20.0);
  const Mode lanchester = lanchester_phugoid(20.0, trim.lift_to_drag, 9.80665);
  EXPECT_NEAR(lanchester.frequency_rad_s(), std::numbers::sqrt2 * 9.80665 / 20.0, 1e-12);
  EXPECT_NEAR(modes.at("phugoid").frequency_rad_s() / lanchester.frequency_rad_s(), 1.0, 0.02);
}

TEST(Modes, TheRollModeIsTheRollDamping) {
  // Pure roll: dp/dt = L_p p with L_p = rho V S b^2 C_ell_p/(4 J_xx) (Etkin, sec. 6.8).
  const Hangar hangar("anaconda", {"body.inertia_kg_m2.xz=0", "aero.yaw.p=0"});
  const Trim trim = hangar.trim(18.0);
  const auto modes = modes_of(hangar, 18.0);
  const double l_p = -0.51 * trim.air.density_kg_m3 * 18.0 * 0.52 * 2.08 * 2.08 / (4.0 * 0.24855);
  EXPECT_NEAR(modes.at("roll").real_1_s / l_p, 1.0, 0.05);
}

TEST(Modes, ThePhugoidOfTheSimulatorHasTheEigenvaluesPeriodAndDamping) {
  const std::vector<std::string> still{"environment.atmosphere.model=constant",
                                       "environment.atmosphere.density_kg_m3=1.1",
                                       "battery.model=constant", "battery.constant_voltage_V=24"};
  Hangar faster("anaconda", still);
  Hangar slower("anaconda", still);
  const Trim trim = faster.trim({18.0, 0.0, 0.0, 500.0});
  const Mode phugoid = modes_of(faster, 18.0).at("phugoid");
  BodyState start = trim.body;
  start.v_B = 1.002 * trim.body.v_B;
  ASSERT_TRUE(faster.dynamics.set_state(start, trim.module_state));
  start.v_B = 0.998 * trim.body.v_B;
  ASSERT_TRUE(slower.dynamics.set_state(start, trim.module_state));
  // The difference of the two leaves out what both do.
  std::vector<double> crossings;
  std::vector<double> swings;
  double last = 0.0;
  double most = 0.0;
  for (int i = 1; i <= 12000 && crossings.size() < 3; ++i) {
    faster.dynamics.step(hal::microseconds(2500 * i), trim.outputs);
    slower.dynamics.step(hal::microseconds(2500 * i), trim.outputs);
    const double now =
        faster.dynamics.truth().body.v_B.norm() - slower.dynamics.truth().body.v_B.norm();
    most = std::max(most, std::abs(now));
    if (now * last < 0.0) {
      crossings.push_back(2.5e-3 * (i - now / (now - last)));
      swings.push_back(most);
      most = 0.0;
    }
    last = now;
  }
  ASSERT_EQ(crossings.size(), 3U);
  // Half a period each, while the slow trace of the spiral is small beside it.
  const double half = std::numbers::pi / phugoid.imaginary_rad_s;
  EXPECT_NEAR((crossings[1] - crossings[0]) / half, 1.0, 0.01);
  EXPECT_NEAR(std::log(swings[2] / swings[1]), phugoid.real_1_s * half, 0.05);
}

}  // namespace
}  // namespace rosflight::sim::test
