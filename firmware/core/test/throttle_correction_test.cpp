// SPDX-License-Identifier: BSD-3-Clause
// THR_VOLT_COMP: a throttle that nobody moves gives the same thrust on an emptier battery.
#include <limits>

#include "firmware/core/motor_model.hpp"
#include "firmware/core/test/command_rig.hpp"
#include "firmware/core/test/firmware_rig.hpp"

namespace rosflight::core {
namespace {

constexpr float kFull_V = 25.2f;  // six lithium cells

// ---- the law

TEST(FullBatteryFactor, IsFullOverMeasuredVoltageLessTwoPercent) {
  EXPECT_EQ(full_battery_factor(kFull_V, kFull_V), 1.0f);
  EXPECT_FLOAT_EQ(full_battery_factor(24.0f, kFull_V), 1.029f);
  EXPECT_FLOAT_EQ(full_battery_factor(22.1f, kFull_V), 1.1174661f);
}

TEST(FullBatteryFactor, NeverLowersAThrottleAndAddsAFifthAtMost) {
  EXPECT_EQ(full_battery_factor(27.0f, kFull_V), 1.0f);
  EXPECT_EQ(full_battery_factor(24.7f, kFull_V), 1.0f) << "less than 2 % are missing";
  EXPECT_EQ(full_battery_factor(20.5f, kFull_V), 1.2f);
  EXPECT_EQ(full_battery_factor(15.2f, kFull_V), 1.2f);
}

TEST(FullBatteryFactor, IsOneForAVoltageThatNoBatteryHas) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // 0.6 and 1.1 times 25.2 V are 15.12 and 27.72 V.
  for (const float voltage_V : {15.1f, 27.8f, 0.0f, -1.0f, nan}) {
    EXPECT_EQ(full_battery_factor(voltage_V, kFull_V), 1.0f) << voltage_V;
  }
  for (const float full_V : {0.0f, nan}) {
    EXPECT_EQ(full_battery_factor(22.1f, full_V), 1.0f) << full_V;
  }
  EXPECT_EQ(full_battery_factor(0.0f, 0.0f), 1.0f);
}

TEST(FullBatteryFactor, KeepsTheThrustOfTheMotorModelAndNeverExceedsIt) {
  const MotorModel motor;
  constexpr float kDensity = 1.225f, kThrottle = 0.6f;
  const auto thrust = [&](float throttle, float voltage_V) {
    return motor.speed_sq_rad2_s2(throttle * voltage_V, kDensity);
  };
  const float full = thrust(kThrottle, kFull_V);
  for (const float now_V : {22.1f, 23.0f, 24.5f, 25.2f}) {
    // Also of a sensor that reads 2 % too low.
    const float corrected = kThrottle * full_battery_factor(0.98f * now_V, kFull_V);
    EXPECT_LE(thrust(corrected, now_V), full * 1.0001f) << now_V;
    EXPECT_GT(thrust(corrected, now_V), full * 0.99f) << now_V;
  }
  // Without it a fifth of the thrust is gone.
  EXPECT_LT(thrust(kThrottle, 22.1f), full * 0.8f);
}

// ---- whose throttle

TEST_F(CommandTest, TheFactorRaisesThePilotsThrottleToOneAtMost) {
  command_.set_throttle_factor(1.14f);
  pilot_.throttle = 0.5f;
  pilot_.roll = 0.5f;
  pass();
  EXPECT_FLOAT_EQ(combined(2), 0.57f);
  EXPECT_FLOAT_EQ(combined(3), 0.393f) << "angles are not concerned";
  pilot_.throttle = 0.9f;
  pass();
  EXPECT_EQ(combined(2), 1.0f);
  pilot_.throttle = 0.0f;
  pass();
  EXPECT_EQ(combined(2), 0.0f);
}

TEST_F(CommandTest, TheFactorLeavesTheCompanionsThrottle) {
  command_.set_throttle_factor(1.14f);
  companion_flies();
  pass();
  EXPECT_EQ(combined(2), 0.5f);
}

TEST_F(CommandTest, ANewFactorActsOnTheFailsafeThrottleWithoutAReceiver) {
  config_.failsafe_throttle = 0.4f;
  configure();
  failsafe_ = true;
  idle(20);
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
  command_.set_throttle_factor(1.1f);
  idle(20);
  EXPECT_FLOAT_EQ(combined(2), 0.44f);
  command_.set_throttle_factor(1.2f);
  idle(20);
  EXPECT_FLOAT_EQ(combined(2), 0.48f) << "of the parameter, not of the one before";
}

// ---- the whole firmware

class ThrottleCorrection : public testing::Test {
 protected:
  /// Armed, stick at half throttle, with an unfiltered battery of six cells.
  void fly(std::int32_t chosen, std::int32_t motor_parameters = 0) {
    rig_.store_quadrotor();
    rig_.store([&](Parameters& p) {
      ASSERT_NE(p.set_int(Param::kThrVoltComp, chosen), SetResult::kOutOfRange);
      ASSERT_NE(p.set_int(Param::kUseMotorParam, motor_parameters), SetResult::kOutOfRange);
      ASSERT_EQ(p.set_float(Param::kBattVoltMax, kFull_V), SetResult::kChanged);
      ASSERT_EQ(p.set_float(Param::kBattVoltLpf, 0.0f), SetResult::kChanged);
    });
    rig_.start();
    rig_.board.battery.put({rig_.now(), kFull_V, 1.0f});
    rig_.arm();
    rig_.rc.channels[FirmwareRig::kThrottle] = 0.5f;
    rig_.run_for(100);
  }
  float output_at(float voltage_V) {
    rig_.board.battery.put({rig_.now(), voltage_V, 1.0f});
    rig_.run_for(50);
    return rig_.outputs()[0];
  }
  FirmwareRig rig_;
};

TEST_F(ThrottleCorrection, TheStickMeansTheSameThrustOnAnEmptierBattery) {
  fly(1);
  const float full = output_at(kFull_V);
  EXPECT_NEAR(full, 0.35f, 1e-4f) << "0.5 of RC_MAX_THR";
  EXPECT_NEAR(output_at(22.1f) / full, 1.1174661f, 1e-4f);
  EXPECT_NEAR(output_at(3.0f) / full, 1.0f, 1e-4f) << "a sensor that has failed";
  EXPECT_NEAR(output_at(18.0f) / full, 1.2f, 1e-4f);
}

TEST_F(ThrottleCorrection, ASilentSensorLeavesTheLastFactor) {
  fly(1);
  const float low = output_at(22.1f);
  rig_.run_for(3000);
  EXPECT_NEAR(rig_.outputs()[0], low, 1e-5f);
}

TEST_F(ThrottleCorrection, TheFailsafeThrottleToo) {
  fly(1);
  output_at(22.1f);
  rig_.rc_on = false;
  rig_.run_for(400);
  ASSERT_TRUE(rig_.firmware().state().failsafe());
  // FAILSAFE_THR 0.4 of RC_MAX_THR 0.7.
  EXPECT_NEAR(rig_.outputs()[0], 0.28f * 1.1174661f, 1e-4f);
}

TEST_F(ThrottleCorrection, ByDefaultTheOutputIsThatOfRosflight2OnAnyBattery) {
  EXPECT_EQ(Parameters().get_int(Param::kThrVoltComp), 0);
  fly(0);
  const float full = output_at(kFull_V);
  EXPECT_EQ(output_at(22.1f), full);
}

TEST_F(ThrottleCorrection, WithMotorParametersTheMixerAloneCorrects) {
  rig_.store([](Parameters& p) {
    ASSERT_NE(p.set_float(Param::kMotorIdleThr, 0.0f), SetResult::kOutOfRange);
  });
  fly(1, 1);
  const float full = output_at(kFull_V);
  ASSERT_GT(full, 0.0f);
  EXPECT_NEAR(output_at(22.1f) / full, 25.2f / 22.1f, 1e-3f) << "not its square";
}

}  // namespace
}  // namespace rosflight::core
