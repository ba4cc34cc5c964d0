// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/motor_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rosflight::core {
namespace {

constexpr float kRho = 1.225f;

/// Motor of ROSflight's simulated quadrotor, with the propeller and air its mixing matrix is made
/// for.
MotorModel simulated() {
  MotorModel m;
  m.resistance_ohm = 0.085f;
  m.kv_V_s_rad = 0.02894f;
  m.no_load_current_A = 1.01f;
  m.prop_cq = 0.004286f;
  m.full_voltage_V = 23.5f;
  return m;
}

TEST(MotorModel, VoltagesAreThoseOfTheReference) {
  // Reference run: default motor, 24 V. Printed to seven decimals; four float operations.
  const MotorModel m;
  EXPECT_NEAR(m.voltage_V(0.0f, kRho) / 24.0f, 0.0026250f, 1e-7f);
  EXPECT_NEAR(m.voltage_V(1e4f, kRho) / 24.0f, 0.0748583f, 1e-7f);
  EXPECT_NEAR(m.voltage_V(1.6e5f, kRho) / 24.0f, 0.3053573f, 2e-7f);
  EXPECT_NEAR(m.voltage_V(4.9e5f, kRho) / 24.0f, 0.5565551f, 2e-7f);
}

TEST(MotorModel, MaximumThrustIsThatOfTheReference) {
  EXPECT_NEAR(MotorModel().max_thrust_N(kRho), 292.279f, 1e-3f);
}

TEST(MotorModel, MeetsTheHoverPointOfTheShippedFrame) {
  // 3.9 kg, 1.074 kg/m^3, 23.5 V: 471.67 rad/s, 14.35 V; all out: 754.9 rad/s and 98.0 N.
  const MotorModel m = simulated();
  constexpr float kAir = 1.074f;
  const float per_rotor_N = 3.9f * 9.81f / 4.0f;  // the published figures take 9.81
  const float speed_sq = per_rotor_N / m.thrust_gain(kAir);
  EXPECT_NEAR(std::sqrt(speed_sq), 471.67f, 0.01f);
  EXPECT_NEAR(m.voltage_V(speed_sq, kAir), 14.35f, 0.005f);
  EXPECT_NEAR(m.voltage_V(speed_sq, kAir) / 23.5f, 0.611f, 5e-4f);
  EXPECT_NEAR(std::sqrt(m.speed_sq_rad2_s2(23.5f, kAir)), 754.9f, 0.05f);
  EXPECT_NEAR(m.max_thrust_N(kAir), 98.0f, 0.05f);
}

TEST(MotorModel, ThrustGainsAreThoseOfTheShippedFiles) {
  MotorModel m;
  EXPECT_NEAR(m.thrust_gain(1.225f), 4.903854e-5f, 1e-11f);
  EXPECT_NEAR(m.thrust_gain(1.074f), 4.299379e-5f, 1e-11f);
}

TEST(MotorModel, SpeedAndVoltageInvertEachOther) {
  const MotorModel m;
  for (const float speed_sq : {1.0f, 1e3f, 1e5f, 1e6f}) {
    const float volts = m.voltage_V(speed_sq, kRho);
    // Subtracting R i0 = 0.063 V from 0.08 V costs a digit at 1 rad/s.
    EXPECT_NEAR(m.speed_sq_rad2_s2(volts, kRho) / speed_sq, 1.0f, 1e-5f) << speed_sq;
  }
}

TEST(MotorModel, DoesNotTurnBelowItsStartingVoltage) {
  const MotorModel m;  // R i0 = 0.063 V
  EXPECT_EQ(m.speed_sq_rad2_s2(0.0f, kRho), 0.0f);
  EXPECT_EQ(m.speed_sq_rad2_s2(0.0629f, kRho), 0.0f);
  EXPECT_GT(m.speed_sq_rad2_s2(0.0640f, kRho), 0.0f);
  EXPECT_EQ(m.speed_sq_rad2_s2(-5.0f, kRho), 0.0f);
}

TEST(MotorModel, KeepsItsDigitsWithAlmostNoResistance) {
  // Then the speed is V/K_V less a part in a million; the textbook root would have lost half its
  // digits.
  MotorModel m;
  m.resistance_ohm = 1e-7f;
  EXPECT_NEAR(std::sqrt(m.speed_sq_rad2_s2(25.0f, kRho)) * m.kv_V_s_rad, 25.0f, 1e-3f);
  m.resistance_ohm = 0.0f;
  EXPECT_NEAR(std::sqrt(m.speed_sq_rad2_s2(25.0f, kRho)) * m.kv_V_s_rad, 25.0f, 1e-5f);
  m = MotorModel{};
  m.prop_cq = 0.0f;
  EXPECT_NEAR(std::sqrt(m.speed_sq_rad2_s2(25.0f, kRho)) * m.kv_V_s_rad, 25.0f - 0.063f, 1e-4f);
}

TEST(MotorModel, WithoutAMotorConstantItHasNoThrust) {
  MotorModel m;
  m.kv_V_s_rad = 0.0f;
  EXPECT_FALSE(m.usable());
  EXPECT_EQ(m.max_thrust_N(kRho), 0.0f);
  m.kv_V_s_rad = 1.1e-7f;
  EXPECT_TRUE(m.usable());
}

TEST(MotorModel, ThinAirGivesLessThrustAndMoreSpeed) {
  const MotorModel m;
  EXPECT_LT(m.max_thrust_N(1.0f), m.max_thrust_N(kRho));
  EXPECT_GT(m.speed_sq_rad2_s2(20.0f, 1.0f), m.speed_sq_rad2_s2(20.0f, kRho));
}

}  // namespace
}  // namespace rosflight::core
