// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/command_rig.hpp"

namespace rosflight::core {
namespace {

// ---- the pilot's command

TEST_F(CommandTest, SticksAreAnglesAndARateAndThrottleUnlessConfiguredOtherwise) {
  pilot_.roll = 0.5f, pilot_.pitch = -0.5f, pilot_.yaw = 1.0f, pilot_.throttle = 0.6f;
  pass();
  EXPECT_FLOAT_EQ(combined(3), 0.393f);
  EXPECT_FLOAT_EQ(combined(4), -0.393f);
  EXPECT_FLOAT_EQ(combined(5), 1.507f);
  EXPECT_EQ(type(3), CommandType::kAngle);
  EXPECT_EQ(type(4), CommandType::kAngle);
  EXPECT_EQ(type(5), CommandType::kRate);
  EXPECT_FLOAT_EQ(combined(2), 0.6f) << "RC_MAX_THR acts later";
  EXPECT_EQ(combined(0), 0.0f);
  EXPECT_EQ(combined(1), 0.0f);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(type(k), CommandType::kThrottle);
  for (std::size_t k = 6; k < 10; ++k) {
    EXPECT_EQ(combined(k), 0.0f);
    EXPECT_EQ(type(k), CommandType::kPassThrough);
  }
}

TEST_F(CommandTest, RateModeScalesWithTheRates) {
  config_.angle_mode = false;
  configure();
  pilot_.roll = 0.5f, pilot_.pitch = -1.0f;
  pass();
  EXPECT_EQ(type(3), CommandType::kRate);
  EXPECT_EQ(type(4), CommandType::kRate);
  EXPECT_FLOAT_EQ(combined(3), 3.14159f / 2);
  EXPECT_FLOAT_EQ(combined(4), -3.14159f);
}

TEST_F(CommandTest, AMappedTypeSwitchDecidesWhateverRcAttModeSays) {
  config_.type_switch_mapped = true;
  for (const bool angle_mode : {false, true}) {
    config_.angle_mode = angle_mode;
    configure();
    for (const bool on : {false, true}) {
      set_switch(Switch::kAttitudeType, on);
      pass();
      EXPECT_EQ(type(3), on ? CommandType::kAngle : CommandType::kRate);
      EXPECT_EQ(type(4), on ? CommandType::kAngle : CommandType::kRate);
      EXPECT_EQ(type(5), CommandType::kRate);
    }
  }
}

TEST_F(CommandTest, ThrottleStickDrivesTheConfiguredEntry) {
  for (std::uint8_t axis = 0; axis < 3; ++axis) {
    config_.throttle_axis = axis;
    configure();
    pilot_.throttle = 0.7f;
    pass();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(combined(k), k == axis ? 0.7f : 0.0f);
  }
}

TEST_F(CommandTest, AFixedWingPilotGoesStraightThrough) {
  config_.fixed_wing = true;
  config_.throttle_axis = 0;
  configure();
  pilot_ = {0.5f, -0.6f, 0.7f, 0.8f, {}};
  pass();
  EXPECT_EQ(combined(0), 0.8f);
  EXPECT_EQ(combined(3), 0.5f);
  EXPECT_EQ(combined(4), -0.6f);
  EXPECT_EQ(combined(5), 0.7f);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(type(k), CommandType::kPassThrough);
}

// ---- override word

// Weak points 14 and 15: ROSflight 2.x showed 0x3DC or garbage during the first second.
TEST(CommandAtBoot, NothingIsDeflectedBeforeTheFirstFrame) {
  CommandManager command;
  command.configure({});
  EXPECT_TRUE(command.update(milliseconds(1), {}, false, false)) << "word changed";
  EXPECT_EQ(command.override_word(), kNobodyOffboard);
  EXPECT_EQ(command.combined().value, (std::array<float, 10>{}));
  EXPECT_FALSE(command.offboard_active());
}

TEST_F(CommandTest, NothingOverridesAWillingPilotsCompanion) {
  companion_flies();
  pass();
  EXPECT_EQ(word(), 0);
  EXPECT_TRUE(command_.offboard_active());
  EXPECT_EQ(command_.primary_axes(), 0) << "everything goes through the secondary mixer";
}

TEST_F(CommandTest, EveryCombinationOfReasonsGivesItsWordAndTheSheetsMixture) {
  // All ten reasons, alone and together; masks 0x222, 0x045, 0x089, 0x111 as in the sheet.
  constexpr std::array<std::uint16_t, 6> kMask{0x222, 0x222, 0x222, 0x045, 0x089, 0x111};
  constexpr std::array<float, 10> kCompanion{0.01f, 0.02f, 0.5f, 0.1f, -0.2f,
                                             0.3f,  1.0f,  2.0f, 3.0f, 4.0f};
  for (unsigned reasons = 0; reasons < 1024; ++reasons) {
    const auto has = [reasons](unsigned bit) { return (reasons & bit) != 0; };
    for (const bool whole : {false, true}) {
      CommandManager command;
      CommandManager::Config config;
      config.override_whole = whole;
      command.configure(config);
      PilotInput pilot;
      pilot.on[static_cast<std::size_t>(Switch::kAttitudeOverride)] = has(0x001);
      pilot.on[static_cast<std::size_t>(Switch::kThrottleOverride)] = has(0x002);
      pilot.roll = has(0x004) ? 0.2f : 0.05f;
      pilot.pitch = has(0x008) ? -0.3f : -0.05f;
      pilot.yaw = has(0x010) ? 0.4f : 0.05f;
      pilot.throttle = has(0x020) ? 0.4f : 0.6f;
      std::uint16_t ignore = 0;
      if (has(0x040)) ignore |= 1u << 3;
      if (has(0x080)) ignore |= 1u << 4;
      if (has(0x100)) ignore |= 1u << 5;
      if (has(0x200)) ignore |= 1u << 2;
      ASSERT_TRUE(command.set_offboard(milliseconds(5000), {kAngles, 0, kCompanion}, 0.0f));
      ASSERT_TRUE(command.set_offboard(milliseconds(5000), {kAngles, ignore, kCompanion}, 0.0f));
      command.update(milliseconds(5000), pilot, true, false);

      ASSERT_EQ(command.override_word(), reasons);
      const std::array<float, 6> sticks{0.0f,
                                        0.0f,
                                        pilot.throttle,
                                        pilot.roll * config.max_roll_rad,
                                        pilot.pitch * config.max_pitch_rad,
                                        pilot.yaw * config.max_yaw_rate_rad_s};
      unsigned primary = 0;
      for (std::size_t k = 0; k < 6; ++k) {
        const bool own = whole ? reasons != 0 : (reasons & kMask[k]) != 0;
        if (own) primary |= 1u << k;
        ASSERT_EQ(command.combined().value[k], own ? sticks[k] : kCompanion[k])
            << "word " << reasons << " entry " << k << " whole " << whole;
        ASSERT_EQ(command.combined().is_active(k),
                  own || (static_cast<unsigned>(ignore) >> k & 1u) == 0);
      }
      for (std::size_t k = 6; k < 10; ++k) {
        ASSERT_EQ(command.combined().value[k], kCompanion[k]);
      }
      ASSERT_EQ(command.primary_axes(), primary);
    }
  }
}

TEST_F(CommandTest, DeviationIsStrictlyMoreThanItsLimit) {
  companion_flies();
  pilot_.roll = 0.1f;
  pass();
  EXPECT_EQ(word() & override_bit::kStickRoll, 0);
  pilot_.roll = 0.101f;
  pass();
  EXPECT_EQ(word() & override_bit::kStickRoll, override_bit::kStickRoll);
}

TEST_F(CommandTest, TellsWhenTheWordChangesAndOnlyThen) {
  companion_flies();
  EXPECT_FALSE(pass()) << "0 before, 0 after";
  EXPECT_FALSE(pass());
  set_switch(Switch::kAttitudeOverride, true);
  EXPECT_TRUE(pass());
  EXPECT_FALSE(pass());
}

// ---- hold (weak point 13)

TEST_F(CommandTest, StickOverrideHoldsFromTheRelease) {
  for (const std::int64_t held_ms : {100, 900, 1200, 5000}) {
    config_.offboard_timeout = milliseconds(100'000);
    configure();
    companion_flies();
    pilot_.pitch = 0.5f;
    for (std::int64_t t = 0; t < held_ms; t += 20) pass();
    pilot_.pitch = 0.0f;
    for (std::int64_t t = 20; t < 1000; t += 20) {
      pass();
      ASSERT_EQ(word(), override_bit::kStickPitch) << "held " << held_ms << " released " << t;
    }
    pass();
    EXPECT_EQ(word(), 0) << "held " << held_ms << ": one second after the release";
  }
}

TEST_F(CommandTest, HoldEndsOnTimeBetweenTwoFrames) {
  config_.offboard_timeout = milliseconds(100'000);
  configure();
  companion_flies();
  pilot_.yaw = 0.5f;
  pass();
  pilot_.yaw = 0.0f;
  pass(1);
  EXPECT_FALSE(idle(998));
  EXPECT_EQ(word(), override_bit::kStickYaw);
  EXPECT_TRUE(idle(1));
  EXPECT_EQ(word(), 0);
}

TEST_F(CommandTest, EachStickHoldsForItself) {
  config_.offboard_timeout = milliseconds(100'000);
  configure();
  companion_flies();
  pilot_.roll = 0.5f;
  pass();
  pilot_.roll = 0.0f;
  pilot_.pitch = 0.5f;
  pass(500);
  EXPECT_EQ(word(), override_bit::kStickRoll | override_bit::kStickPitch);
  pilot_.pitch = 0.0f;
  pass(500);
  EXPECT_EQ(word(), override_bit::kStickPitch);
}

TEST_F(CommandTest, NoHoldTimeMeansNoHold) {
  config_.stick_hold = Time{0};
  configure();
  companion_flies();
  pilot_.roll = 0.5f;
  pass();
  EXPECT_EQ(word(), override_bit::kStickRoll);
  pilot_.roll = 0.0f;
  pass();
  EXPECT_EQ(word(), 0);
}

// ---- failsafe

TEST_F(CommandTest, AMultirotorFailsafeIsLevelWithItsThrottle) {
  config_.failsafe_throttle = 0.4f;
  configure();
  EXPECT_TRUE(command_.failsafe_valid());
  pilot_ = {1.0f, 1.0f, 1.0f, 1.0f, {}};
  failsafe_ = true;
  pass();
  EXPECT_EQ(command_.combined().value, (std::array<float, 10>{0, 0, 0.4f, 0, 0, 0, 0, 0, 0, 0}));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(type(k), CommandType::kThrottle);
  EXPECT_EQ(type(3), CommandType::kAngle);
  EXPECT_EQ(type(4), CommandType::kAngle);
  EXPECT_EQ(type(5), CommandType::kRate);
  for (std::size_t k = 6; k < 10; ++k) EXPECT_EQ(type(k), CommandType::kPassThrough);
}

// Weak point 4: ROSflight 2.x froze the word and used the companion's mixer.
TEST_F(CommandTest, FailsafeUsesThePrimaryMixerWhoeverHadControl) {
  config_.failsafe_throttle = 0.4f;
  configure();
  companion_flies();
  pass();
  ASSERT_EQ(command_.primary_axes(), 0);
  failsafe_ = true;
  idle(1);
  EXPECT_EQ(command_.primary_axes(), 0x3FF);
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
  ASSERT_TRUE(offboard(kAngles, {0, 0, 1, 1, 1, 1, 1, 1, 1, 1}));
  idle(1);
  EXPECT_FLOAT_EQ(combined(2), 0.4f) << "the companion has no effect in failsafe";
  EXPECT_EQ(combined(6), 0.0f);
  failsafe_ = false;
  idle(1);
  EXPECT_FLOAT_EQ(combined(3), 0.786f) << "and has control again after it";
}

TEST_F(CommandTest, AFixedWingFailsafeIsAllZeroPassThrough) {
  config_.fixed_wing = true;
  configure();
  EXPECT_TRUE(command_.failsafe_valid()) << "any FAILSAFE_THR will do";
  failsafe_ = true;
  pass();
  EXPECT_EQ(command_.combined().value, (std::array<float, 10>{}));
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(type(k), CommandType::kPassThrough);
}

TEST_F(CommandTest, FailsafeThrottleOutsideZeroToOneIsInvalidAndZero) {
  for (const float thr : {-1.0f, -0.01f, 1.01f, std::numeric_limits<float>::quiet_NaN()}) {
    config_.failsafe_throttle = thr;
    configure();
    EXPECT_FALSE(command_.failsafe_valid()) << thr;
    failsafe_ = true;
    pass();
    EXPECT_EQ(combined(2), 0.0f) << thr;
  }
  for (const float thr : {0.0f, 1.0f}) {
    config_.failsafe_throttle = thr;
    configure();
    EXPECT_TRUE(command_.failsafe_valid()) << thr;
  }
}

// Weak points 5 and 6.
TEST_F(CommandTest, FailsafeIsBuiltAnewForEveryChange) {
  config_.failsafe_throttle = 0.4f;
  config_.fixed_wing = true;
  configure();
  config_.fixed_wing = false;
  configure();
  failsafe_ = true;
  pass();
  EXPECT_EQ(type(2), CommandType::kThrottle);
  EXPECT_EQ(type(3), CommandType::kAngle);
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
  config_.throttle_axis = 0;
  configure();
  idle(1);
  EXPECT_FLOAT_EQ(combined(0), 0.4f);
  EXPECT_EQ(combined(2), 0.0f);
}

// ---- the receiver is lost and the companion may go on

class AngleHold : public CommandTest {
 protected:
  AngleHold() {
    config_.fixed_wing = config_.fixed_wing_holds = true;
    config_.throttle_axis = 0;
    configure();
  }
  void expect_angles(bool held) const {
    const CommandType wanted = held ? CommandType::kAngle : CommandType::kPassThrough;
    EXPECT_EQ(type(3), wanted);
    EXPECT_EQ(type(4), wanted);
    EXPECT_EQ(type(5), CommandType::kPassThrough);
    EXPECT_EQ(type(0), CommandType::kPassThrough);
  }
};

TEST_F(AngleHold, TheFailsafeHoldsRollAndPitchLevel) {
  failsafe_ = true;
  pass();
  expect_angles(true);
  EXPECT_EQ(command_.combined().value, (std::array<float, 10>{}));
}

TEST_F(AngleHold, ASilentCompanionLeavesAnglesThatTheSticksCommand) {
  ASSERT_TRUE(offboard(0, {0.5f, 0, 0, 0.1f, -0.2f, 0.3f}));
  pass();
  expect_angles(false);
  EXPECT_EQ(combined(3), 0.1f) << "the companion's surfaces pass straight through";
  pilot_ = {0.5f, -1.0f, 0.7f, 0.8f, {}};
  idle(200);
  pass();
  expect_angles(true);
  EXPECT_FLOAT_EQ(combined(0), 0.8f);
  EXPECT_FLOAT_EQ(combined(3), 0.393f);
  EXPECT_FLOAT_EQ(combined(4), -0.786f);
  EXPECT_FLOAT_EQ(combined(5), 0.7f);
}

TEST_F(AngleHold, APilotWithTheSwitchHasTheSurfaces) {
  pilot_ = {0.5f, -1.0f, 0.7f, 0.8f, {}};
  set_switch(Switch::kAttitudeOverride, true);
  pass();
  expect_angles(false);
  EXPECT_FLOAT_EQ(combined(3), 0.5f);
}

class CompanionInFailsafe : public CommandTest {
 protected:
  CompanionInFailsafe() {
    config_.failsafe_throttle = 0.4f;
    config_.companion_in_failsafe = true;
    configure();
  }
};

TEST_F(CompanionInFailsafe, FreshCommandsOfTheCompanionStayInForce) {
  companion_flies();
  pass();
  failsafe_ = true;
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f}));
    idle(20);
    ASSERT_FALSE(command_.in_failsafe()) << k;
    ASSERT_FLOAT_EQ(combined(2), 0.5f);
    ASSERT_FLOAT_EQ(combined(3), 0.1f);
  }
  EXPECT_EQ(command_.primary_axes() & 0x3F, 0);
}

TEST_F(CompanionInFailsafe, WithTheCompanionSilentTooTheFailsafeCommandFollowsItsTimeout) {
  companion_flies();
  pass();
  failsafe_ = true;
  idle(10);
  EXPECT_FALSE(command_.in_failsafe());
  EXPECT_TRUE(idle(100)) << "the status reports it";
  EXPECT_TRUE(command_.in_failsafe());
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
  EXPECT_FLOAT_EQ(combined(3), 0.0f);
  // And back with the first command.
  ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f}));
  EXPECT_TRUE(idle(1));
  EXPECT_FALSE(command_.in_failsafe());
  EXPECT_FLOAT_EQ(combined(2), 0.5f);
}

TEST_F(CompanionInFailsafe, AnAxisThatThePilotHeldIsNotTheCompanions) {
  companion_flies();
  set_switch(Switch::kAttitudeOverride, true);
  pass();
  failsafe_ = true;
  idle(10);
  EXPECT_TRUE(command_.in_failsafe());
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
}

TEST_F(CompanionInFailsafe, TheLastThrottleStickOfASilentTransmitterDoesNotCount) {
  companion_flies();
  pilot_.throttle = 0.0f;
  pass();
  ASSERT_EQ(word(), override_bit::kMinThrottle) << "with a receiver it does";
  failsafe_ = true;
  idle(10);
  EXPECT_FALSE(command_.in_failsafe());
  EXPECT_FLOAT_EQ(combined(2), 0.5f);
}

TEST_F(CompanionInFailsafe, AMaskedAxisIsNobodysSoTheFailsafeCommandFlies) {
  ASSERT_TRUE(offboard(kAngles, {0.0f, 0.0f, 0.5f, 0.1f, -0.2f, 0.3f}, 0x08));
  failsafe_ = true;
  idle(10);
  EXPECT_TRUE(command_.in_failsafe());
}

TEST_F(CommandTest, ByDefaultALostReceiverEndsTheCompanionsFlightAtOnce) {
  config_.failsafe_throttle = 0.4f;
  configure();
  companion_flies();
  pass();
  failsafe_ = true;
  idle(1);
  EXPECT_TRUE(command_.in_failsafe());
  EXPECT_FLOAT_EQ(combined(2), 0.4f);
}

// Weak point 14: times are 64 bits of microseconds.
TEST_F(CommandTest, NothingHappensWhenA32BitClockWouldWrap) {
  config_.offboard_timeout = milliseconds(100);
  configure();
  for (const std::int64_t wrap_us :
       {1LL << 31, 1LL << 32, (1LL << 31) * 1000, (1LL << 32) * 1000}) {
    now_ = hal::microseconds(wrap_us) - milliseconds(500);
    for (int k = 0; k < 500; ++k) {
      companion_flies();
      pass(2);
      ASSERT_EQ(word(), 0) << now_.count();
    }
  }
}

}  // namespace
}  // namespace rosflight::core
