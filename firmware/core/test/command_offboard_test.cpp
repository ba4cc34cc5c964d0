// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/test/command_rig.hpp"

namespace rosflight::core {
namespace {

// ---- offboard commands

TEST_F(CommandTest, ModesGiveEachEntryItsType) {
  using T = CommandType;
  struct Case {
    std::uint8_t mode;
    T force, attitude, yaw;
  };
  for (const Case& c : {Case{kPassThrough, T::kPassThrough, T::kPassThrough, T::kPassThrough},
                        Case{kRates, T::kThrottle, T::kRate, T::kRate},
                        Case{kAngles, T::kThrottle, T::kAngle, T::kRate}}) {
    pilot_.throttle = 1.0f;
    ASSERT_TRUE(offboard(c.mode, {}));
    pass();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(type(k), c.force);
    EXPECT_EQ(type(3), c.attitude);
    EXPECT_EQ(type(4), c.attitude);
    EXPECT_EQ(type(5), c.yaw);
    for (std::size_t k = 6; k < 10; ++k) EXPECT_EQ(type(k), T::kPassThrough);
  }
}

TEST_F(CommandTest, UnknownModesAreRefusedWhole) {
  companion_flies();
  for (int mode = 3; mode < 256; ++mode) {
    EXPECT_FALSE(offboard(static_cast<std::uint8_t>(mode), {9, 9, 9, 9, 9, 9, 9, 9, 9, 9}));
  }
  pass();
  EXPECT_FLOAT_EQ(combined(3), 0.1f);
}

TEST_F(CommandTest, NotANumberIsRefusedWholeUnlessMasked) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    for (std::size_t k = 0; k < 10; ++k) {
      companion_flies();
      std::array<float, 10> u{};
      u[k] = bad;
      EXPECT_FALSE(offboard(kAngles, u)) << "entry " << k;
      pass();
      EXPECT_FLOAT_EQ(combined(3), 0.1f) << "entry " << k;
      EXPECT_TRUE(offboard(kAngles, u, static_cast<std::uint16_t>(1u << k))) << "entry " << k;
      pass();
      for (const float v : command_.combined().value) EXPECT_TRUE(std::isfinite(v));
    }
  }
}

TEST_F(CommandTest, MaskedEntriesAreThePilots) {
  pilot_ = {0.05f, 0.06f, 0.07f, 0.9f, {}};
  ASSERT_TRUE(offboard(kAngles, {0, 0, 0.5f, 0.1f, 0.2f, 0.3f, 0, 0, 0, 0}, 1u << 4));
  pass();
  EXPECT_EQ(word(), override_bit::kPitchInactive);
  EXPECT_FLOAT_EQ(combined(3), 0.1f);
  EXPECT_FLOAT_EQ(combined(4), 0.06f * 0.786f);
  EXPECT_FLOAT_EQ(combined(5), 0.3f);
  EXPECT_FLOAT_EQ(combined(2), 0.5f);
  EXPECT_TRUE(command_.offboard_active());
}

TEST_F(CommandTest, OffboardCountsAsActiveForEntriesZeroToFive) {
  ASSERT_TRUE(offboard(kAngles, {}, 0x03F));
  pass();
  EXPECT_FALSE(command_.offboard_active()) << "free entries alone";
  for (unsigned k = 0; k < 6; ++k) {
    ASSERT_TRUE(offboard(kAngles, {}, static_cast<std::uint16_t>(0x3FF & ~(1u << k))));
    pass();
    EXPECT_TRUE(command_.offboard_active()) << k;
  }
}

// Weak point 1: a companion at 400 Hz was sampled at the rate of the receiver.
TEST_F(CommandTest, AnOffboardCommandIsInForceWithoutAReceiverFrame) {
  companion_flies();
  pass();
  ASSERT_TRUE(offboard(kAngles, {0, 0, 0.5f, 0.25f, 0, 0, 0, 0, 0, 0}));
  idle(1);
  EXPECT_FLOAT_EQ(combined(3), 0.25f);
}

TEST_F(CommandTest, OffboardEndsAfterItsTimeOutWithoutAReceiverFrame) {
  companion_flies();
  const Time sent = now_;
  command_.update(now_, pilot_, true, false);
  EXPECT_FALSE(command_.update(sent + milliseconds(100), pilot_, false, false));
  EXPECT_EQ(word(), 0) << "exactly OFFBOARD_TIMEOUT old";
  EXPECT_TRUE(
      command_.update(sent + milliseconds(100) + hal::microseconds(1), pilot_, false, false));
  EXPECT_EQ(word(), kNobodyOffboard);
  EXPECT_FALSE(command_.offboard_active());
  EXPECT_FLOAT_EQ(combined(2), 0.9f) << "the pilot's";
}

TEST_F(CommandTest, AShorterTimeOutActsOnTheCommandInForce) {
  companion_flies();
  pass();
  config_.offboard_timeout = milliseconds(10);
  configure();
  idle(1);
  EXPECT_FALSE(command_.offboard_active());
}

// Weak points 9 and 10.
TEST_F(CommandTest, FreeEntriesAreZeroAfterTheTimeOutAndGoThroughThePrimaryMixer) {
  companion_flies();
  pass();
  EXPECT_EQ(command_.primary_axes() & 0x3C0, 0);
  EXPECT_EQ(combined(6), 1.0f);
  idle(80);
  EXPECT_EQ(combined(6), 1.0f) << "still in time";
  now_ += hal::microseconds(1);
  command_.update(now_, pilot_, false, failsafe_);
  for (std::size_t k = 6; k < 10; ++k) {
    EXPECT_EQ(combined(k), 0.0f);
    EXPECT_FALSE(command_.combined().is_active(k));
  }
  EXPECT_EQ(command_.primary_axes(), 0x3FF);
}

TEST_F(CommandTest, AMaskedEntryIsZeroUnlessThePilotHasIt) {
  companion_flies();
  ASSERT_TRUE(offboard(kAngles, {0.3f, 0.4f, 0.5f, 0, 0, 0, 0.9f, 0.9f, 0.9f, 0.9f}));
  pass();
  EXPECT_FLOAT_EQ(combined(0), 0.3f);
  ASSERT_TRUE(offboard(kAngles, {0.3f, 0.4f, 0.5f, 0, 0, 0, 0.9f, 0.9f, 0.9f, 0.9f}, 1u << 7 | 1u));
  pass();
  EXPECT_EQ(combined(0), 0.0f) << "not what it was before";
  EXPECT_FLOAT_EQ(combined(1), 0.4f);
  EXPECT_FLOAT_EQ(combined(6), 0.9f);
  EXPECT_EQ(combined(7), 0.0f);
  EXPECT_EQ(command_.primary_axes(), 1u << 7);
}

TEST_F(CommandTest, ForgottenOffboardCommandsAreAsIfTheyHadNeverCome) {
  companion_flies();
  pass();
  ASSERT_TRUE(command_.offboard_active());
  command_.forget_offboard();
  EXPECT_TRUE(idle(1));
  EXPECT_FALSE(command_.offboard_active());
  EXPECT_EQ(word(), kNobodyOffboard);
  EXPECT_EQ(command_.combined().value, (std::array<float, 10>{0, 0, 0.9f}));
  EXPECT_EQ(command_.primary_axes(), 0x3FF);
  companion_flies();
  pass();
  EXPECT_EQ(word(), 0) << "the next one counts";
}

// ---- limits of what the companion may command

TEST_F(CommandTest, AnglesAndRatesAreLimitedToThoseOfTheSticksAndThrottleToZeroAndOne) {
  config_.max_roll_rad = 0.5f, config_.max_pitch_rad = 0.4f;
  config_.max_roll_rate_rad_s = 3.0f, config_.max_pitch_rate_rad_s = 2.0f;
  config_.max_yaw_rate_rad_s = 1.0f;
  configure();
  pilot_.throttle = 1.5f;  // leaves the throttle to the companion
  struct Case {
    std::uint8_t mode;
    std::array<float, 6> high;
  };
  for (const Case& c :
       {Case{kAngles, {1, 1, 1, 0.5f, 0.4f, 1.0f}}, Case{kRates, {1, 1, 1, 3.0f, 2.0f, 1.0f}}}) {
    for (std::size_t k = 0; k < 6; ++k) {
      const float low = k < 3 ? 0.0f : -c.high[k];
      for (const auto& [asked, used] : {std::pair{c.high[k], c.high[k]},
                                        {1.001f * c.high[k], c.high[k]},
                                        {20.0f, c.high[k]},
                                        {3e38f, c.high[k]},
                                        {low, low},
                                        {low - 0.001f, low},
                                        {-20.0f, low},
                                        {-3e38f, low},
                                        {0.5f * c.high[k], 0.5f * c.high[k]},
                                        {0.0f, 0.0f}}) {
        std::array<float, 10> u{};
        u[k] = asked;
        const std::uint32_t before = command_.limited().count;
        ASSERT_TRUE(offboard(c.mode, u));
        pass();
        EXPECT_EQ(combined(k), used) << "mode " << int{c.mode} << " entry " << k << " " << asked;
        EXPECT_EQ(command_.limited().count - before, asked != used ? 1u : 0u);
        if (asked == used) continue;
        EXPECT_EQ(command_.limited().axis, k);
        EXPECT_EQ(command_.limited().requested, asked);
        EXPECT_EQ(command_.limited().used, used);
      }
    }
  }
}

TEST_F(CommandTest, PassThroughEntriesAreLimitedByTheMixerInEveryMode) {
  std::array<float, 10> limits;
  for (std::size_t k = 0; k < 10; ++k) limits[k] = 0.5f + static_cast<float>(k);
  command_.set_axis_limits(limits);
  configure();  // other settings leave them alone
  pilot_.throttle = 1.5f;
  for (const std::uint8_t mode : {kPassThrough, kRates, kAngles}) {
    for (std::size_t k = mode == kPassThrough ? 0 : 6; k < 10; ++k) {
      for (const float sign : {-1.0f, 1.0f}) {
        std::array<float, 10> u{};
        u[k] = sign * limits[k];
        ASSERT_TRUE(offboard(mode, u));
        pass();
        EXPECT_EQ(combined(k), sign * limits[k]);
        u[k] = sign * 1e9f;
        ASSERT_TRUE(offboard(mode, u));
        pass();
        EXPECT_EQ(combined(k), sign * limits[k]) << "mode " << int{mode} << " entry " << k;
      }
    }
  }
}

TEST_F(CommandTest, ARefusedOrMaskedValueIsNotCountedAsLimited) {
  pilot_.throttle = 1.5f;
  EXPECT_FALSE(offboard(kAngles, {0, 0, 0.5f, 20.0f, std::numeric_limits<float>::infinity()}));
  ASSERT_TRUE(offboard(kAngles, {0, 0, 0.5f, 20.0f}, 1u << 3));
  pass();
  EXPECT_EQ(combined(3), 0.0f) << "the pilot's";
}

TEST_F(CommandTest, ALimitOfZeroLeavesZero) {
  config_.max_roll_rad = 0.0f;
  configure();
  pilot_.throttle = 1.5f;
  ASSERT_TRUE(offboard(kAngles, {0, 0, 0.5f, -0.3f}));
  pass();
  EXPECT_EQ(combined(3), 0.0f);
}

// ---- least throttle

TEST_F(CommandTest, TheLowerThrottleWinsUnlessSwitchedOff) {
  companion_flies();
  pilot_.throttle = 0.49f;
  pass();
  EXPECT_EQ(word(), override_bit::kMinThrottle);
  EXPECT_FLOAT_EQ(combined(2), 0.49f);
  EXPECT_FLOAT_EQ(combined(3), 0.1f) << "attitude stays the companion's";
  pilot_.throttle = 0.5f;
  pass();
  EXPECT_EQ(word(), 0) << "equal is not lower";
  pilot_.throttle = 0.0f;
  config_.take_min_throttle = false;
  configure();
  pass();
  EXPECT_EQ(word(), 0);
}

// Weak point 12: F_z = -0.6 is more than any stick position, as a number.
TEST_F(CommandTest, InPassThroughTheThrustAskedForIsCompared) {
  const std::array<float, 10> u{0, 0, -0.6f, 0, 0, 0, 0, 0, 0, 0};
  pilot_.throttle = 0.0f;
  ASSERT_TRUE(offboard(kPassThrough, u, 0, 0.6f));
  pass();
  EXPECT_EQ(word(), override_bit::kMinThrottle);
  EXPECT_EQ(combined(2), 0.0f);
  pilot_.throttle = 0.86f;  // times RC_MAX_THR 0.7 = 0.602
  pass();
  EXPECT_EQ(word(), 0);
  EXPECT_FLOAT_EQ(combined(2), -0.6f);
  pilot_.throttle = 0.85f;  // 0.595
  pass();
  EXPECT_EQ(word(), override_bit::kMinThrottle);
}

TEST_F(CommandTest, TorquesOfAPassThroughCompanionScaleWithTheThrustThatThePilotLeaves) {
  const std::array<float, 10> u{0.1f, 0, -0.6f, 0.4f, -0.2f, 0.3f, 0.9f, 0, 0, 0};
  config_.max_throttle = 0.5f;
  configure();
  struct Case {
    float stick, companion, share;
  };
  for (const Case& c : {Case{0.6f, 0.6f, 0.5f}, Case{0.3f, 0.6f, 0.25f}, Case{0.0f, 0.6f, 0.0f},
                        Case{-0.2f, 0.6f, 0.0f}, Case{-0.2f, 0.0f, 0.0f},
                        // the pilot has more than was asked for: nothing is taken over
                        Case{1.2f, 0.6f, 1.0f}, Case{0.0f, 0.0f, 1.0f}}) {
    pilot_.throttle = c.stick;
    ASSERT_TRUE(offboard(kPassThrough, u, 0, c.companion));
    pass();
    for (std::size_t k = 3; k < 6; ++k) {
      EXPECT_FLOAT_EQ(combined(k), c.share * u[k]) << c.stick << " " << c.companion;
    }
    EXPECT_EQ(combined(6), 0.9f) << "free entries are no torques";
  }
  // Whatever gives the pilot the thrust: a switch, or a masked entry.
  set_switch(Switch::kThrottleOverride, true);
  pilot_.throttle = 0.0f;
  ASSERT_TRUE(offboard(kPassThrough, u, 0, 0.0f));
  pass();
  EXPECT_EQ(combined(3), 0.0f);
  set_switch(Switch::kThrottleOverride, false);
  ASSERT_TRUE(offboard(kPassThrough, u, 1u << 2, 0.2f));
  pass();
  EXPECT_EQ(combined(3), 0.0f);
  pilot_.throttle = 0.5f;  // 0.25, more than the torques need
  pass();
  EXPECT_EQ(combined(3), 0.4f);
}

TEST_F(CommandTest, AnglesRatesSticksAndFixedWingsAreNotScaled) {
  for (const std::uint8_t mode : {kRates, kAngles}) {
    pilot_ = {};
    ASSERT_TRUE(offboard(mode, {0, 0, 0.5f, 0.4f, -0.2f, 0.3f}));
    pass();
    ASSERT_EQ(word(), override_bit::kMinThrottle);
    EXPECT_EQ(combined(3), 0.4f);
  }
  pilot_.roll = 0.2f;
  ASSERT_TRUE(offboard(kPassThrough, {0, 0, -0.6f, 0.4f, -0.2f, 0.3f}, 0, 0.6f));
  pass();
  EXPECT_FLOAT_EQ(combined(3), 0.2f * 0.786f) << "the pilot's own";
  EXPECT_EQ(combined(4), 0.0f);
  config_.fixed_wing = true;
  config_.throttle_axis = 0;
  configure();
  pilot_ = {};
  ASSERT_TRUE(offboard(kPassThrough, {0.5f, 0, 0, 0.4f, -0.2f, 0.3f}, 0, 0.5f));
  pass(2000);
  ASSERT_TRUE(offboard(kPassThrough, {0.5f, 0, 0, 0.4f, -0.2f, 0.3f}, 0, 0.5f));
  pass();
  ASSERT_EQ(word(), override_bit::kMinThrottle);
  EXPECT_EQ(combined(0), 0.0f);
  EXPECT_EQ(combined(3), 0.4f) << "surfaces need no throttle";
}

TEST_F(CommandTest, AFixedWingComparesStickAndEntry) {
  config_.fixed_wing = true;
  config_.throttle_axis = 0;
  configure();
  pilot_.throttle = 0.4f;
  ASSERT_TRUE(offboard(kPassThrough, {0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  pass();
  EXPECT_EQ(word(), override_bit::kMinThrottle);
  pilot_.throttle = 0.6f;
  pass();
  EXPECT_EQ(word(), 0);
}

// ---- whole override (weak point 11)

TEST_F(CommandTest, WithTwoMixersOneStickTakesAllSixEntries) {
  config_.override_whole = true;
  configure();
  companion_flies();
  pilot_.roll = 0.5f;
  pass();
  EXPECT_EQ(word(), override_bit::kStickRoll);
  EXPECT_FLOAT_EQ(combined(2), 0.9f);
  EXPECT_FLOAT_EQ(combined(3), 0.393f);
  EXPECT_EQ(combined(4), 0.0f);
  EXPECT_EQ(command_.primary_axes(), 0x3F);
  EXPECT_EQ(combined(6), 1.0f) << "free entries stay the companion's";
}

}  // namespace
}  // namespace rosflight::core
