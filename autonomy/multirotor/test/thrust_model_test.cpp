// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/thrust_model.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "autonomy/multirotor/test/plant.hpp"

namespace rosflight::autonomy::multirotor {
namespace {

ThrustModel model(double rc_max_thr = 1.0) {
  return ThrustModel(ThrustModel::curve_of(test::default_rotors()), {rc_max_thr, 0.0});
}

TEST(ThrustModel, MatchesTheStaticThrustTableOfTheDefaultQuadrotor) {
  // ROSflight 2.x simulator, default multirotor: thrust per rotor against motor output, printed to
  // 4 digits.
  const double table[][2] = {
      {0.10, 0.3691}, {0.30, 3.3831}, {0.50, 9.3057}, {0.70, 17.9953}, {1.00, 35.9361}};
  for (const auto& [output, rotor_N] : table) {
    EXPECT_NEAR(model().thrust_N(output), 4.0 * rotor_N, 4.0 * 5.1e-5) << output;
    EXPECT_NEAR(model().throttle(4.0 * rotor_N), output, 2e-5) << output;
  }
  EXPECT_NEAR(model().throttle(3.5 * 9.81), 0.479918, 1e-6);  // hover
}

TEST(ThrustModel, RotorsStartToTurnAboveTheIdleLosses) {
  EXPECT_EQ(model().thrust_N(0.002625), 0.0);
  EXPECT_GT(model().thrust_N(0.0027), 0.0);
  EXPECT_EQ(model().throttle(0.0), 0.0);
  EXPECT_EQ(model().throttle(-5.0), 0.0);
}

TEST(ThrustModel, DividesByTheThrottleScaleOfTheFirmware) {
  EXPECT_NEAR(model(0.7).throttle(3.5 * 9.81) * 0.7, 0.479918, 1e-6);
  EXPECT_NEAR(model(0.7).max_thrust_N(), 4.0 * 17.9953, 4.0 * 5.1e-5);
}

TEST(ThrustModel, InvertsItselfAtAnyVoltageAndDensity) {
  for (const double voltage_V : {0.0, 20.0, 25.2}) {
    for (const double density : {0.8, 1.0, 1.1}) {
      for (int k = 1; k < 20; ++k) {
        const double thrust_N = 3.0 * k;
        const double throttle = model().throttle(thrust_N, voltage_V, density);
        ASSERT_LT(throttle, 1.0);
        EXPECT_NEAR(model().thrust_N(throttle, voltage_V, density), thrust_N, 1e-9);
      }
    }
  }
}

TEST(ThrustModel, TiredBatteryNeedsMoreThrottle) {
  EXPECT_NEAR(model().throttle(34.335, 20.0), 0.479918 * 24.0 / 20.0, 2e-6);
}

TEST(ThrustModel, ClipsAtFullThrottle) {
  EXPECT_EQ(model().throttle(1e6), 1.0);
  EXPECT_EQ(model().thrust_N(7.0), model().thrust_N(1.0));
}

TEST(ThrustModel, FirmwareThatKnowsItsMotorsTakesAShareOfItsLargestThrust) {
  const ThrustModel newtons(ThrustModel::curve_of(test::default_rotors()), {0.7, 98.0});
  EXPECT_NEAR(newtons.throttle(34.3), 0.5, 1e-12);
  EXPECT_NEAR(newtons.thrust_N(0.5), 34.3, 1e-12);
  EXPECT_NEAR(newtons.max_thrust_N(), 68.6, 1e-12);
}

TEST(ThrustModel, RefusesNonsense) {
  const ThrustModel::Curve good = ThrustModel::curve_of(test::default_rotors());
  const auto with = [&](auto change) {
    ThrustModel::Curve curve = good;
    change(curve);
    return curve;
  };
  EXPECT_THROW(ThrustModel(with([](auto& c) { c.max_thrust_N = 0.0; }), {}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(with([](auto& c) { c.constant = 1.0; }), {}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(with([](auto& c) { c.root = 1.2; }), {}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(good, {0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(good, {1.1, 0.0}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(good, {1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW(ThrustModel(ThrustModel::curve_of({}), {}), std::invalid_argument);  // 0/0
}

}  // namespace
}  // namespace rosflight::autonomy::multirotor
