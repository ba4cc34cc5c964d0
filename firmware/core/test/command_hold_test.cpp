// SPDX-License-Identifier: BSD-3-Clause
// OFFBOARD_HOLD: what a silent companion leaves to a multirotor in the air, and when it is in the air.
#include "firmware/core/test/command_rig.hpp"

namespace rosflight::core {
namespace {

constexpr Time kHold = milliseconds(1200);

/// A companion that flies alone: the pilot's throttle stick is at idle. In the air unless a test arms again.
class OffboardHold : public CommandTest {
 protected:
  OffboardHold() {
    config_.offboard_hold = kHold;
    config_.failsafe_throttle = 0.4f;
    config_.take_min_throttle = false;
    configure();
    command_.arm(now_, true);
  }
  void companion_commands(float throttle, std::uint8_t mode = kAngles) {
    ASSERT_TRUE(offboard(mode, {0.0f, 0.0f, throttle, 0.1f, -0.2f, 0.3f, 1.0f}, 0,
                         throttle * config_.max_throttle));
    pass(0);
  }
  /// Commands at 50 Hz.
  void companion_flies(float throttle, std::int64_t duration_ms, std::uint8_t mode = kAngles) {
    for (std::int64_t t = 0; t < duration_ms; t += 20) {
      companion_commands(throttle, mode);
      now_ += milliseconds(20);
    }
    companion_commands(throttle, mode);
  }
  bool holds_when_silent() {
    idle(101);
    return command_.offboard_active();
  }
  void expect_level(float throttle) {
    EXPECT_EQ(word(), 0);
    EXPECT_TRUE(command_.offboard_active());
    EXPECT_FLOAT_EQ(combined(2), throttle);
    for (std::size_t k = 3; k < 10; ++k) EXPECT_EQ(combined(k), 0.0f) << k;
    EXPECT_EQ(type(3), CommandType::kAngle);
    EXPECT_EQ(type(4), CommandType::kAngle);
    EXPECT_EQ(type(5), CommandType::kRate);
  }
};

// ---- what is held

TEST_F(OffboardHold, AMomentOfSilenceLeavesTheThrustAndLevels) {
  for (const std::uint8_t mode : {kAngles, kRates, kPassThrough}) {
    companion_commands(0.5f, mode);
    EXPECT_FALSE(idle(100)) << "exactly OFFBOARD_TIMEOUT old";
    EXPECT_FLOAT_EQ(combined(3), 0.1f);
    now_ += hal::microseconds(1);
    EXPECT_FALSE(command_.update(now_, pilot_, false, false)) << "nobody else commands";
    expect_level(0.5f);
    EXPECT_EQ(type(2), mode == kPassThrough ? CommandType::kPassThrough : CommandType::kThrottle);
    EXPECT_EQ(command_.primary_axes() & 0x3F, 0);
    pass(1190);
    expect_level(0.5f);
  }
}

TEST_F(OffboardHold, AfterItThePilotHasEveryAxisWithoutAReceiverFrame) {
  companion_commands(0.5f);
  idle(101);
  idle(1199);
  expect_level(0.5f);
  now_ += hal::microseconds(1);
  EXPECT_TRUE(command_.update(now_, pilot_, false, false)) << "the status reports it";
  EXPECT_EQ(word(), kNobodyOffboard);
  EXPECT_EQ(combined(2), 0.0f);
}

TEST_F(OffboardHold, WithoutTheParameterThePilotHasEveryAxisAtTheTimeout) {
  config_.offboard_hold = Time{};
  configure();
  companion_commands(0.5f);
  EXPECT_FALSE(holds_when_silent());
  EXPECT_EQ(word(), kNobodyOffboard);
}

TEST_F(OffboardHold, TheNextCommandEndsIt) {
  companion_commands(0.5f);
  idle(1000);
  ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.45f, 0.2f, 0.0f, 0.0f}));
  idle(1);
  EXPECT_FLOAT_EQ(combined(2), 0.45f);
  EXPECT_FLOAT_EQ(combined(3), 0.2f);
}

TEST_F(OffboardHold, ThePilotTakesWhatHeMovesAtOnce) {
  companion_commands(0.5f);
  idle(500);
  pilot_.roll = 0.5f;
  pass();
  EXPECT_EQ(word(), override_bit::kStickRoll);
  EXPECT_FLOAT_EQ(combined(3), 0.5f * 0.786f);
  EXPECT_FLOAT_EQ(combined(2), 0.5f);
  set_switch(Switch::kThrottleOverride, true);
  pass();
  EXPECT_EQ(combined(2), 0.0f);
}

TEST_F(OffboardHold, AThrottleStickThatLimitsTheCompanionLimitsTheHold) {
  config_.take_min_throttle = true;
  configure();
  pilot_.throttle = 0.9f;
  companion_commands(0.5f);
  idle(500);
  pilot_.throttle = 0.3f;
  pass();
  EXPECT_EQ(word(), override_bit::kMinThrottle);
  EXPECT_FLOAT_EQ(combined(2), 0.3f);
}

TEST_F(OffboardHold, TheFailsafeCommandDoesNotWaitForIt) {
  config_.companion_in_failsafe = true;
  configure();
  for (const std::int64_t silent_ms : {0, 600}) {  // receiver first, companion first
    failsafe_ = false;
    companion_commands(0.5f);
    idle(silent_ms);
    EXPECT_TRUE(command_.offboard_active());
    failsafe_ = true;
    idle(101);
    EXPECT_TRUE(command_.in_failsafe());
    EXPECT_FALSE(command_.offboard_active());
    EXPECT_FLOAT_EQ(combined(2), 0.4f);
    failsafe_ = false;
    pass();
    EXPECT_EQ(word(), kNobodyOffboard) << "an ended hold stays ended";
  }
}

TEST_F(OffboardHold, AMaskedAxisStaysThePilots) {
  ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f}, 1u << 4));
  pilot_.pitch = 0.05f;
  pass(0);
  idle(500);
  EXPECT_EQ(word(), override_bit::kPitchInactive);
  EXPECT_FLOAT_EQ(combined(4), 0.05f * 0.786f);
  ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f}, 1u << 2));
  pass(0);
  EXPECT_FALSE(holds_when_silent()) << "no thrust to keep";
}

TEST_F(OffboardHold, NeitherAFixedWingNorAVehicleWithTwoMixersHasIt) {
  for (const bool fixed_wing : {true, false}) {
    config_.fixed_wing = fixed_wing;
    config_.override_whole = !fixed_wing;
    configure();
    companion_commands(0.5f);
    EXPECT_FALSE(holds_when_silent()) << fixed_wing;
  }
}

// ---- in the air or on the ground

TEST_F(OffboardHold, ItIsInTheAirAfterASecondOfMoreThanTheFailsafeThrottle) {
  for (const std::uint8_t mode : {kAngles, kRates, kPassThrough}) {
    command_.arm(now_, false);
    companion_flies(0.41f, 880, mode);
    EXPECT_FALSE(holds_when_silent()) << "its thrust was in force for 100 ms more";
    command_.arm(now_, false);
    companion_flies(0.41f, 1000, mode);
    EXPECT_TRUE(command_.in_air());
    EXPECT_TRUE(holds_when_silent());
    pass(2000);
  }
}

TEST_F(OffboardHold, AThrustThatSinksIsNoLiftOff) {
  command_.arm(now_, false);
  companion_flies(0.4f, 5000);
  EXPECT_FALSE(command_.in_air());
  companion_flies(0.6f, 900);
  companion_flies(0.3f, 20);
  companion_flies(0.6f, 900);
  EXPECT_FALSE(command_.in_air()) << "the second begins again";
  failsafe_ = true;
  for (int k = 0; k < 250; ++k) pass();
  EXPECT_TRUE(command_.in_failsafe());
  EXPECT_FALSE(command_.in_air());
}

TEST_F(OffboardHold, ThePilotsThrustCountsToo) {
  command_.arm(now_, false);
  pilot_.throttle = 0.5f;
  for (int k = 0; k <= 51; ++k) pass();
  EXPECT_TRUE(command_.in_air());
  pilot_.throttle = 0.0f;
  companion_commands(0.5f);
  EXPECT_TRUE(holds_when_silent());
}

TEST_F(OffboardHold, ADescentIsInTheAir) {
  companion_flies(0.21f, 10'000);
  EXPECT_TRUE(holds_when_silent());
  EXPECT_FLOAT_EQ(combined(2), 0.21f);
}

TEST_F(OffboardHold, ASecondOfHalfTheFailsafeThrottleIsTheGround) {
  companion_flies(0.2f, 960);
  companion_commands(0.5f);
  EXPECT_TRUE(holds_when_silent()) << "in a shorter time nobody lands";
  companion_flies(0.2f, 1000);
  companion_commands(0.5f);
  EXPECT_FALSE(command_.in_air());
  EXPECT_FALSE(holds_when_silent());
}

TEST_F(OffboardHold, AThrustThatCarriesNothingIsNotKept) {
  companion_flies(0.5f, 500);
  companion_commands(0.2f);
  EXPECT_FALSE(holds_when_silent());
  EXPECT_TRUE(command_.in_air());
}

TEST_F(OffboardHold, DisarmedOrArmedOnTheGroundItIsOnTheGround) {
  companion_commands(0.5f);
  ASSERT_TRUE(holds_when_silent());
  command_.disarm();
  idle(1);
  EXPECT_FALSE(command_.offboard_active()) << "a hold ends with the motors";
  companion_flies(0.5f, 3000);
  EXPECT_FALSE(command_.in_air()) << "no motor turns";
  command_.arm(now_, false);
  EXPECT_FALSE(holds_when_silent());
  command_.arm(now_, true);
  companion_commands(0.5f);
  EXPECT_TRUE(holds_when_silent());
}

TEST_F(OffboardHold, TheThrustIsHeldWhileTheVoltageFalls) {
  command_.set_throttle_factor(1.05f);
  companion_commands(0.5f);
  command_.set_throttle_factor(1.0f);
  pass();
  EXPECT_FLOAT_EQ(combined(2), 0.5f) << "the companion's own, it is there";
  idle(101);
  command_.set_throttle_factor(1.1f);
  idle(20);
  expect_level(0.55f);
  command_.set_throttle_factor(1.2f);
  idle(20);
  expect_level(0.6f);
  command_.set_throttle_factor(1.0f);
  idle(20);
  expect_level(0.5f);
  companion_commands(0.9f);
  idle(101);
  command_.set_throttle_factor(1.2f);
  idle(20);
  expect_level(1.0f);
  companion_commands(0.9f);
  EXPECT_FLOAT_EQ(combined(2), 0.9f) << "it is back";
}

TEST_F(OffboardHold, OnAWeakBatteryTheSameThrustIsMoreThrottle) {
  command_.set_throttle_factor(1.2f);
  command_.arm(now_, false);
  companion_flies(0.47f, 5000);
  EXPECT_FALSE(command_.in_air());
  companion_flies(0.49f, 1000);
  EXPECT_TRUE(command_.in_air());
}

}  // namespace
}  // namespace rosflight::core
