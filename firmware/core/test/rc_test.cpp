// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/rc.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace rosflight::core {
namespace {

using hal::milliseconds;

constexpr std::size_t kRoll = 0, kPitch = 1, kThrottle = 2, kYaw = 3;
constexpr std::int64_t kFrame_ms = 20;

hal::RcFrame centred() {
  hal::RcFrame f;
  f.channel_count = 8;
  f.channels.fill(0.5f);
  f.channels[kThrottle] = 0.0f;
  for (std::size_t k = 4; k < f.channels.size(); ++k) f.channels[k] = 0.0f;
  return f;
}

class RcTest : public testing::Test {
 protected:
  /// One frame, `after_ms` after the last pass.
  Rc::Update frame(std::int64_t after_ms = kFrame_ms) {
    now_ += milliseconds(after_ms);
    return rc_.step(now_, &frame_, armed_);
  }
  Rc::Update silence(std::int64_t after_ms) {
    now_ += milliseconds(after_ms);
    return rc_.step(now_, nullptr, armed_);
  }
  void configure() { rc_.configure(config_); }
  void arm_by_sticks() {
    frame_.channels[kThrottle] = 0.0f;
    frame_.channels[kYaw] = 1.0f;
  }

  Rc rc_;
  Rc::Config config_;
  hal::RcFrame frame_{centred()};
  Time now_{milliseconds(5000)};
  bool armed_{false};
};

// ---- sticks and validity

TEST_F(RcTest, NothingIsOnAndAllIsCentredBeforeTheFirstFrame) {
  EXPECT_EQ(rc_.input().roll, 0.0f);
  EXPECT_EQ(rc_.input().throttle, 0.0f);
  for (const bool on : rc_.input().on) EXPECT_FALSE(on);
}

TEST_F(RcTest, SticksAreScaledAndNotClipped) {
  frame_.channels[kRoll] = 1.1f;
  frame_.channels[kPitch] = -0.05f;
  frame_.channels[kYaw] = 0.75f;
  frame_.channels[kThrottle] = 1.2f;
  EXPECT_TRUE(frame().frame);
  EXPECT_FLOAT_EQ(rc_.input().roll, 1.2f);
  EXPECT_FLOAT_EQ(rc_.input().pitch, -1.1f);
  EXPECT_FLOAT_EQ(rc_.input().yaw, 0.5f);
  EXPECT_FLOAT_EQ(rc_.input().throttle, 1.2f);
}

TEST_F(RcTest, SticksFollowTheirChannels) {
  config_.roll = 7, config_.pitch = 6, config_.throttle = 5, config_.yaw = 4;
  config_.channel_count = 8;
  configure();
  frame_.channels[7] = 0.6f, frame_.channels[6] = 0.7f, frame_.channels[5] = 0.8f;
  frame_.channels[4] = 0.9f;
  frame();
  EXPECT_FLOAT_EQ(rc_.input().roll, 0.2f);
  EXPECT_FLOAT_EQ(rc_.input().pitch, 0.4f);
  EXPECT_FLOAT_EQ(rc_.input().throttle, 0.8f);
  EXPECT_FLOAT_EQ(rc_.input().yaw, 0.8f);
}

TEST_F(RcTest, LimitsOfAValidChannelAreInclusive) {
  for (const float good : {-0.25f, 1.25f}) {
    frame_.channels[kPitch] = good;
    EXPECT_TRUE(frame().found) << good;
  }
  for (const float bad : {-0.251f, 1.251f, std::numeric_limits<float>::quiet_NaN()}) {
    frame_.channels[kPitch] = bad;
    const auto update = frame();
    EXPECT_FALSE(update.found) << bad;
    EXPECT_FALSE(update.frame) << bad;
  }
}

TEST_F(RcTest, OnlyTheFirstChannelsAreChecked) {
  config_.channel_count = 6;
  configure();
  frame_.channels[6] = 9.0f;
  EXPECT_TRUE(frame().found);
  frame_.channels[5] = 9.0f;
  EXPECT_FALSE(frame().found);
}

// Weak point 74.
TEST_F(RcTest, AStickIsCheckedWhereverItsChannelLies) {
  config_.channel_count = 4;
  config_.yaw = 7;
  configure();
  frame_.channels[7] = 9.0f;
  EXPECT_FALSE(frame().found);
  frame_.channels[7] = 0.5f;
  EXPECT_TRUE(frame().found);
}

TEST_F(RcTest, ABadFrameChangesNothing) {
  frame_.channels[kRoll] = 0.8f;
  frame_.channels[4] = 1.0f;
  frame();
  const PilotInput before = rc_.input();
  frame_ = centred();
  frame_.frame_lost = true;
  EXPECT_FALSE(frame().frame);
  EXPECT_EQ(rc_.input().roll, before.roll);
  EXPECT_EQ(rc_.input().on, before.on);
}

// ---- loss (weak points 2 and 3)

TEST_F(RcTest, FailsafeFlagIsLossAtOnce) {
  frame();
  frame_.failsafe = true;
  EXPECT_TRUE(frame(1).lost);
}

TEST_F(RcTest, BadFramesAreLossAfterATenthOfASecond) {
  for (const bool flagged : {true, false}) {
    frame_ = centred();
    EXPECT_FALSE(frame().lost);
    frame_.frame_lost = flagged;
    if (!flagged) frame_.channels[kRoll] = 2.0f;
    for (int k = 0; k < 9; ++k) EXPECT_FALSE(frame(11).lost) << k;  // 99 ms
    EXPECT_TRUE(frame(1).lost);                                     // 100 ms
  }
}

TEST_F(RcTest, AGoodFrameInBetweenStartsTheDebouncingAnew) {
  for (int k = 0; k < 20; ++k) {
    frame_.frame_lost = k % 4 != 0;
    EXPECT_FALSE(frame(20).lost) << k;
  }
}

TEST_F(RcTest, SilenceIsLossAfterTwoTenthsOfASecondAndTheFirstGoodFrameEndsIt) {
  frame();
  EXPECT_FALSE(silence(100).lost);
  EXPECT_FALSE(silence(99).lost);
  EXPECT_TRUE(silence(1).lost);
  EXPECT_TRUE(silence(5000).lost);
  const auto back = frame();
  EXPECT_TRUE(back.found);
  EXPECT_FALSE(back.lost);
}

TEST(RcAtBoot, SilenceFromTheStartIsLossToo) {
  Rc rc;
  EXPECT_FALSE(rc.step(milliseconds(199), nullptr, false).lost);
  EXPECT_TRUE(rc.step(milliseconds(200), nullptr, false).lost);
}

// ---- switches

TEST_F(RcTest, ASwitchIsMappedFromChannelFourToTheLastThatCounts) {
  config_.channel_count = 7;
  for (int channel = 0; channel < 256; ++channel) {
    config_.switch_channel.fill(static_cast<std::uint8_t>(channel));
    configure();
    for (std::size_t s = 0; s < kSwitchCount; ++s) {
      EXPECT_EQ(rc_.mapped(static_cast<Switch>(s)), channel >= 4 && channel < 7) << channel;
    }
  }
}

// Weak point 74.
TEST_F(RcTest, FewerChannelsUnmapASwitchAtOnce) {
  config_.channel_count = 6;
  config_.switch_channel[1] = 5;
  configure();
  EXPECT_TRUE(rc_.mapped(Switch::kAttitudeOverride));
  config_.channel_count = 5;
  configure();
  EXPECT_FALSE(rc_.mapped(Switch::kAttitudeOverride));
}

TEST_F(RcTest, AnUnmappedSwitchIsOff) {
  config_.switch_channel.fill(255);
  configure();
  frame_.channels.fill(1.0f);
  frame();
  for (const bool on : rc_.input().on) EXPECT_FALSE(on);
}

TEST_F(RcTest, SwitchThresholdsDependOnItsDirection) {
  config_.channel_count = 8;
  struct Case {
    float value;
    std::int8_t direction;
    bool on;
  };
  const Case cases[] = {{0.79f, 1, false}, {0.8f, 1, true},   {1.0f, 1, true},   {0.79f, 0, false},
                        {0.8f, 0, true},   {0.2f, -1, false}, {0.19f, -1, true}, {0.0f, -1, true},
                        {1.0f, -1, false}, {0.0f, 1, false},  {0.5f, -1, false}, {0.5f, 1, false}};
  for (std::uint8_t channel = 4; channel < 8; ++channel) {
    config_.switch_channel = {255, channel, 255, 255};
    for (const Case& c : cases) {
      config_.direction.fill(1);
      config_.direction[channel - 4u] = c.direction;
      configure();
      frame_.channels[channel] = c.value;
      frame();
      EXPECT_EQ(rc_.input().is_on(Switch::kAttitudeOverride), c.on)
          << "channel " << int{channel} << " direction " << int{c.direction} << " at " << c.value;
    }
    frame_.channels[channel] = 0.5f;
  }
}

TEST_F(RcTest, EachSwitchReadsItsOwnChannel) {
  config_.channel_count = 8;
  config_.switch_channel = {4, 5, 6, 7};
  configure();
  for (std::size_t on = 0; on < kSwitchCount; ++on) {
    for (std::size_t k = 0; k < kSwitchCount; ++k) frame_.channels[4 + k] = k == on ? 1.0f : 0.0f;
    frame();
    for (std::size_t k = 0; k < kSwitchCount; ++k) {
      EXPECT_EQ(rc_.input().is_on(static_cast<Switch>(k)), k == on);
    }
  }
}

TEST_F(RcTest, TellsTheMappingOfEverySwitch) {
  config_.switch_channel = {5, 4, 255, 3};
  configure();
  Log log;
  rc_.describe(log);
  EXPECT_STREQ(log.pop().text.data(), "arm switch on channel 5");
  EXPECT_STREQ(log.pop().text.data(), "attitude override switch on channel 4");
  EXPECT_STREQ(log.pop().text.data(), "throttle override switch not mapped");
  EXPECT_STREQ(log.pop().text.data(), "attitude type switch not mapped");
  EXPECT_TRUE(log.empty());
}

TEST_F(RcTest, ASwitchOnAChannelThatTheReceiverLacksIsOff) {
  config_.channel_count = 8;
  config_.switch_channel = {255, 4, 5, 6};
  configure();
  frame_.channels.fill(1.0f);  // leftovers beyond channel_count
  for (int count = 4; count <= 8; ++count) {
    frame_.channel_count = static_cast<std::uint8_t>(count);
    ASSERT_TRUE(frame().found) << count;
    for (std::size_t s = 1; s < kSwitchCount; ++s) {
      EXPECT_EQ(rc_.input().on[s], static_cast<int>(s) + 3 < count) << count;
    }
  }
}

TEST_F(RcTest, AFrameThatLacksAStickIsBadAndWhatItDoesNotCarryIsNotChecked) {
  config_.channel_count = 8;
  configure();
  frame_.channels[5] = 9.0f;
  for (int count = 0; count < 4; ++count) {
    frame_.channel_count = static_cast<std::uint8_t>(count);
    EXPECT_FALSE(frame().found) << count;
  }
  for (const int count : {4, 5}) {
    frame_.channel_count = static_cast<std::uint8_t>(count);
    EXPECT_TRUE(frame().found) << count;
  }
  frame_.channel_count = 6;
  EXPECT_FALSE(frame().found) << "channel 5 is out of range";
  frame_.channels[5] = 0.0f;
  frame_.channel_count = 255;
  EXPECT_TRUE(frame().found) << "no more than there can be";
}

// ---- arming by sticks

TEST_F(RcTest, SticksArmAfterMoreThanOneSecondInTheCorner) {
  frame();
  arm_by_sticks();
  for (std::int64_t t = kFrame_ms; t <= 1000; t += kFrame_ms) {
    EXPECT_FALSE(frame().arm) << t << " ms";
  }
  EXPECT_TRUE(frame().arm);
  EXPECT_TRUE(frame().arm) << "repeated until it is obeyed";
}

TEST_F(RcTest, SticksDisarmAfterMoreThanOneSecondInTheOtherCorner) {
  armed_ = true;
  frame();
  frame_.channels[kYaw] = 0.0f;
  for (std::int64_t t = kFrame_ms; t <= 1000; t += kFrame_ms) {
    EXPECT_FALSE(frame().disarm) << t << " ms";
  }
  EXPECT_TRUE(frame().disarm);
  EXPECT_FALSE(frame().disarm) << "the timer starts again";
}

TEST_F(RcTest, LeavingTheCornerStartsTheSecondAnew) {
  frame();
  arm_by_sticks();
  for (int k = 0; k < 45; ++k) frame();
  frame_.channels[kThrottle] = 0.15f;  // not below RC_ARM_THRESHOLD
  frame();
  frame_.channels[kThrottle] = 0.14f;
  for (std::int64_t t = kFrame_ms; t <= 1000; t += kFrame_ms) EXPECT_FALSE(frame().arm);
  EXPECT_TRUE(frame().arm);
}

TEST_F(RcTest, TheCornerIsWithinTheThreshold) {
  frame();
  arm_by_sticks();
  frame_.channels[kYaw] = 0.92f;  // stick 0.84, needed more than 0.85
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(frame().arm);
  frame_.channels[kYaw] = 0.93f;
  for (int k = 0; k < 100; ++k) frame();
  EXPECT_TRUE(frame().arm);
}

TEST_F(RcTest, TheWrongCornerDoesNothing) {
  for (const bool armed : {false, true}) {
    armed_ = armed;
    arm_by_sticks();
    frame_.channels[kYaw] = armed ? 1.0f : 0.0f;
    for (int k = 0; k < 200; ++k) {
      const auto update = frame();
      EXPECT_FALSE(update.arm || update.disarm);
    }
  }
}

// Weak point 16: ROSflight 2.x armed on the first frame.
TEST_F(RcTest, TheFirstFrameAfterBootOrAnOutageSaysNothingAboutTheTimeBefore) {
  arm_by_sticks();
  EXPECT_FALSE(frame().arm) << "at t = 5 s";
  for (int k = 0; k < 25; ++k) frame();  // half a second
  silence(60'000);
  EXPECT_FALSE(frame().arm);
  for (std::int64_t t = kFrame_ms; t <= 1000; t += kFrame_ms) EXPECT_FALSE(frame().arm);
  EXPECT_TRUE(frame().arm);
}

TEST(RcAtBoot, AFirstFrameShortlyAfterBootDoesNotCountTheTimeSinceBoot) {
  Rc rc;
  hal::RcFrame corner = centred();
  corner.channels[kYaw] = 1.0f;
  std::int64_t t_ms = 90;
  rc.step(milliseconds(t_ms), &corner, false);
  for (; t_ms < 1090; t_ms += 20) {
    EXPECT_FALSE(rc.step(milliseconds(t_ms + 20), &corner, false).arm) << t_ms + 20;
  }
  EXPECT_TRUE(rc.step(milliseconds(t_ms + 20), &corner, false).arm);
}

// ---- arming by switch

class RcWithArmSwitch : public RcTest {
 protected:
  RcWithArmSwitch() {
    config_.switch_channel[0] = 5;
    configure();
  }
  void set_switch(bool on) { frame_.channels[5] = on ? 1.0f : 0.0f; }
  /// Frames at the standard rate until the switch has been off for long enough.
  void wait_off() {
    set_switch(false);
    for (std::int64_t t = 0; t <= 100; t += kFrame_ms) frame();
  }
};

TEST_F(RcWithArmSwitch, ArmsOnTheFirstOnAndDisarmsWhenEveryFrameOfATenthOfASecondSaidOff) {
  struct Rate {
    std::int64_t period_us;
    int frames;  ///< That have the switch off before it counts: the first, and those until 100 ms later.
  };
  for (const Rate& rate : {Rate{20'000, 6}, Rate{9'000, 13}, Rate{2'000, 51}, Rate{50'000, 3}}) {
    SCOPED_TRACE(rate.period_us);
    const auto next = [&](bool on) {
      set_switch(on);
      now_ += hal::microseconds(rate.period_us);
      return rc_.step(now_, &frame_, armed_);
    };
    for (int k = 0; k < 100; ++k) static_cast<void>(next(false));
    EXPECT_TRUE(next(true).arm);
    for (int k = 0; k < 100; ++k) {
      const auto update = next(true);
      ASSERT_FALSE(update.arm || update.disarm);
    }
    for (int glitch = 1; glitch < rate.frames; ++glitch) {
      for (int k = 0; k < glitch; ++k) ASSERT_FALSE(next(false).disarm) << glitch << " " << k;
      ASSERT_FALSE(next(true).arm) << glitch << " frames off permit no arming";
    }
    for (int k = 1; k < rate.frames; ++k) ASSERT_FALSE(next(false).disarm) << k;
    EXPECT_TRUE(next(false).disarm);
    EXPECT_TRUE(next(false).disarm) << "repeated until it is obeyed";
    EXPECT_TRUE(next(true).arm);
  }
}

TEST_F(RcWithArmSwitch, LostFramesInBetweenSayNothing) {
  for (const std::int64_t period_us : {20'000, 9'000, 2'000}) {
    for (const bool flagged : {true, false}) {
      SCOPED_TRACE(period_us);
      const auto next = [&](bool on, bool lost) {
        set_switch(on);
        frame_.frame_lost = lost && flagged;
        frame_.channels[kRoll] = lost && !flagged ? 2.0f : 0.5f;
        now_ += hal::microseconds(period_us);
        return rc_.step(now_, &frame_, armed_);
      };
      for (int k = 0; k < 100; ++k) static_cast<void>(next(false, false));
      static_cast<void>(next(true, false));
      // Off between lost frames with the switch on, and the other way round: only good ones count.
      Time first{};
      bool disarm = false;
      for (int k = 0; k < 200 && !disarm; ++k) {
        const bool lost = k % 3 != 0;
        disarm = next(lost, lost).disarm;
        if (k == 0) first = now_;
      }
      EXPECT_TRUE(disarm);
      EXPECT_GE(now_ - first, milliseconds(100));
      EXPECT_LE(now_ - first, milliseconds(100) + 3 * hal::microseconds(period_us));
      EXPECT_TRUE(next(true, false).arm);
      for (int k = 0; k < 200; ++k) {
        const bool lost = k % 3 != 0;
        ASSERT_FALSE(next(!lost, lost).disarm);
      }
    }
  }
}

TEST_F(RcWithArmSwitch, TwoFramesAreNotEnoughHoweverFarApart) {
  wait_off();
  set_switch(true);
  frame();
  set_switch(false);
  EXPECT_FALSE(frame().disarm);
  EXPECT_FALSE(frame(99).disarm);
  EXPECT_FALSE(frame(0).disarm) << "99 ms";
  EXPECT_TRUE(frame(1).disarm);
  set_switch(true);
  frame();
  set_switch(false);
  EXPECT_FALSE(frame().disarm);
  EXPECT_FALSE(frame(60).disarm);
  EXPECT_TRUE(frame(60).disarm) << "three in 120 ms";
}

TEST_F(RcWithArmSwitch, AnOutageStartsTheCountAnew) {
  for (const bool bad_frames : {false, true}) {
    wait_off();
    set_switch(true);
    EXPECT_TRUE(frame().arm);
    set_switch(false);
    for (int k = 0; k < 4; ++k) EXPECT_FALSE(frame().disarm);
    frame_.frame_lost = bad_frames;
    bad_frames ? frame(50) : silence(50);
    frame_.frame_lost = false;
    EXPECT_FALSE(frame(50).disarm) << "100 ms after the last good frame";
    for (int k = 0; k < 4; ++k) EXPECT_FALSE(frame().disarm);
    EXPECT_TRUE(frame().disarm);
  }
}

TEST_F(RcWithArmSwitch, OnAfterAnOutageDoesNotArm) {
  wait_off();
  silence(5000);
  set_switch(true);
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(frame().arm);
  wait_off();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
}

// Weak point 17.
TEST_F(RcWithArmSwitch, ASwitchOnAtPowerUpDoesNotArmUntilItWasOff) {
  set_switch(true);
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(frame().arm);
  set_switch(false);
  frame();
  set_switch(true);
  EXPECT_FALSE(frame().arm) << "one frame off is a glitch";
  wait_off();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
}

TEST_F(RcWithArmSwitch, OneEdgeAsksOnce) {
  wait_off();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(frame().arm) << "refused: needs a new edge";
}

TEST_F(RcWithArmSwitch, SticksNoLongerArmOrDisarm) {
  arm_by_sticks();
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(frame().arm);
  set_switch(true);
  frame();
  armed_ = true;
  frame_.channels[kYaw] = 0.0f;
  for (int k = 0; k < 200; ++k) EXPECT_FALSE(frame().disarm);
}

TEST_F(RcWithArmSwitch, AnotherMappingNeedsToSeeTheSwitchOffFirst) {
  config_.channel_count = 8;
  configure();
  wait_off();                 // channel 5 is off
  frame_.channels[6] = 1.0f;  // another switch is on
  config_.switch_channel[0] = 6;
  configure();
  EXPECT_FALSE(frame().arm) << "moved to a channel that is on";
  frame_.channels[6] = 0.0f;
  wait_off();
  config_.direction[2] = -1;
  configure();
  EXPECT_FALSE(frame().arm) << "reversed";
  frame_.channels[6] = 1.0f;
  wait_off();
  frame_.channels[6] = 0.0f;
  EXPECT_TRUE(frame().arm);
}

TEST_F(RcWithArmSwitch, OtherParametersLeaveTheEdgeAlone) {
  wait_off();
  config_.arm_threshold = 0.2f;
  configure();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
}

TEST_F(RcWithArmSwitch, OnAChannelThatTheReceiverLacksItIsUnmappedAndDisarmsNobody) {
  wait_off();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
  armed_ = true;
  set_switch(false);
  for (int k = 0; k < 4; ++k) EXPECT_FALSE(frame().disarm);
  frame_.channel_count = 5;
  for (int k = 0; k < 100; ++k) EXPECT_FALSE(frame().disarm) << "without the channel, no switch";
  frame_.channel_count = 8;
  for (int k = 0; k < 5; ++k) EXPECT_FALSE(frame().disarm) << "and the count restarts";
  EXPECT_TRUE(frame().disarm);
  frame_.channel_count = 5;
  frame_.channels[kYaw] = 0.0f;
  for (std::int64_t t = 0; t < 1080; t += kFrame_ms) EXPECT_FALSE(frame().disarm);
  EXPECT_TRUE(frame().disarm) << "then the sticks disarm";
}

TEST_F(RcWithArmSwitch, AShortFrameAmongLongOnesSaysNothingAboutSwitches) {
  wait_off();
  set_switch(true);
  EXPECT_TRUE(frame().arm);
  armed_ = true;
  set_switch(false);
  frame_.channels[kThrottle] = 0.0f;
  frame_.channels[kYaw] = 1.0f;  // the corner that arms
  bool disarm = false;
  int frames = 0;
  for (; frames < 10 && !disarm; ++frames) {
    frame_.channel_count = frames % 4 == 2 ? 5 : 8;
    const Rc::Update update = frame();
    EXPECT_FALSE(update.arm) << "short frames make no gesture either";
    disarm = update.disarm;
    EXPECT_FALSE(rc_.input().is_on(Switch::kArm)) << frames;
  }
  EXPECT_TRUE(disarm);
  EXPECT_LE(frames, 7);
}

}  // namespace
}  // namespace rosflight::core
