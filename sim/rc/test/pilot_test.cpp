// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rc/pilot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace rosflight::sim::rc {
namespace {

constexpr Time ms(std::int64_t value) {
  return Time{value * 1000};
}

hal::RcFrame frame_at(Pilot& pilot, Time t) {
  hal::RcFrame frame;
  EXPECT_TRUE(pilot.step(t, frame)) << t.count();
  return frame;
}

Event move(Time at, int channel, float to, Time over = Time{0}) {
  return {.at = at, .kind = Event::Kind::kMove, .channel = channel, .to = to, .over = over};
}

TEST(Pilot, StartsWithSticksCentredThrottleDownAndSwitchesOff) {
  Pilot pilot;
  const auto frame = frame_at(pilot, ms(0));
  EXPECT_EQ(frame.channel_count, 8);
  const std::array<float, 8> expected{0.5F, 0.5F, 0.0F, 0.5F, 0.0F, 0.0F, 0.0F, 0.0F};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(frame.channels[i], expected[i]) << i;
  EXPECT_FALSE(frame.frame_lost);
  EXPECT_FALSE(frame.failsafe);
}

TEST(Pilot, SendsFiftyFramesASecond) {
  Pilot pilot;
  hal::RcFrame frame;
  int frames = 0;
  for (std::int64_t t = 0; t < 10'000'000; t += 2500) {
    if (!pilot.step(Time{t}, frame)) continue;
    EXPECT_EQ(t, 20'000 * frames);
    EXPECT_EQ(frame.stamp, Time{t});
    ++frames;
  }
  EXPECT_EQ(frames, 500);
}

TEST(Pilot, SettersMoveTheChannelOfTheControl) {
  Script script;
  script.channels[Control::kArm] = 7;
  Pilot pilot(std::move(script));
  frame_at(pilot, ms(0));
  EXPECT_TRUE(pilot.set_switch(Control::kArm, true));
  EXPECT_TRUE(pilot.set(Control::kThrottle, 0.3F));
  EXPECT_EQ(pilot.position(Control::kArm), 0.0F);  // shows with the next frame
  const auto frame = frame_at(pilot, ms(20));
  EXPECT_EQ(frame.channels[7], 1.0F);
  EXPECT_EQ(frame.channels[2], 0.3F);
  EXPECT_EQ(pilot.position(Control::kArm), 1.0F);
}

TEST(Pilot, BothOverridesMayShareASwitch) {
  Pilot pilot;
  frame_at(pilot, ms(0));
  pilot.set_switch(Control::kAttitudeOverride, true);
  frame_at(pilot, ms(20));
  EXPECT_EQ(pilot.position(Control::kThrottleOverride), 1.0F);
}

TEST(Pilot, AControlWithoutAChannelCannotBeMoved) {
  Script script;
  script.channels[Control::kArm] = -1;
  Pilot pilot(std::move(script));
  EXPECT_FALSE(pilot.set_switch(Control::kArm, true));
  EXPECT_FALSE(pilot.position(Control::kArm).has_value());
  EXPECT_FALSE(pilot.set_channel(8, 0.5F));
  EXPECT_FALSE(pilot.set_channel(-1, 0.5F));
  EXPECT_TRUE(pilot.set_channel(7, 0.5F));
}

TEST(Pilot, RampsRunAtConstantSpeedFromTheNextFrame) {
  Pilot pilot;
  frame_at(pilot, ms(0));
  pilot.set(Control::kThrottle, 1.0F, ms(80));
  const float expected[]{0.0F, 0.25F, 0.5F, 0.75F, 1.0F, 1.0F};
  for (std::int64_t i = 0; i < 6; ++i)
    EXPECT_FLOAT_EQ(frame_at(pilot, ms(20 + 20 * i)).channels[2], expected[i]) << i;
}

TEST(Pilot, WhoMovesLastHasTheChannel) {
  Pilot pilot;
  frame_at(pilot, ms(0));
  pilot.set(Control::kRoll, 1.0F, ms(1000));
  frame_at(pilot, ms(20));
  pilot.set(Control::kRoll, 0.25F);
  EXPECT_EQ(frame_at(pilot, ms(40)).channels[0], 0.25F);
  EXPECT_EQ(frame_at(pilot, ms(500)).channels[0], 0.25F);
}

TEST(Pilot, ScriptedRampsStartAtTheirTimeEvenBetweenFrames) {
  Script script;
  script.events = {move(ms(25), 2, 0.5F), move(ms(30), 2, 1.0F, ms(100))};
  Pilot pilot(std::move(script));
  EXPECT_EQ(frame_at(pilot, ms(20)).channels[2], 0.0F);
  // At 40 ms a tenth of the way from 0.5 to 1 is done.
  EXPECT_FLOAT_EQ(frame_at(pilot, ms(40)).channels[2], 0.55F);
  EXPECT_FLOAT_EQ(frame_at(pilot, ms(120)).channels[2], 0.95F);
  EXPECT_FLOAT_EQ(frame_at(pilot, ms(140)).channels[2], 1.0F);
}

TEST(Pilot, SilenceSendsNothingAndTimeGoesOn) {
  Script script;
  script.events = {{.at = ms(100), .kind = Event::Kind::kSilence},
                   move(ms(150), 4, 1.0F),
                   {.at = ms(200), .kind = Event::Kind::kSilence, .begins = false}};
  Pilot pilot(std::move(script));
  hal::RcFrame frame;
  for (std::int64_t t = 0; t < 300; t += 20) {
    EXPECT_EQ(pilot.step(ms(t), frame), t < 100 || t >= 200) << t;
  }
  EXPECT_EQ(frame.channels[4], 1.0F);
  pilot.set_silent(true);
  EXPECT_FALSE(pilot.step(ms(300), frame));
  pilot.set_silent(false);
  EXPECT_TRUE(pilot.step(ms(320), frame));
}

TEST(Pilot, FlaggedFramesRepeatTheLastGoodOne) {
  Pilot pilot;
  pilot.set(Control::kThrottle, 0.4F);
  frame_at(pilot, ms(0));
  pilot.set(Control::kThrottle, 0.9F);
  pilot.set_frame_lost(true);
  auto frame = frame_at(pilot, ms(20));
  EXPECT_TRUE(frame.frame_lost);
  EXPECT_EQ(frame.channels[2], 0.4F);
  pilot.set_frame_lost(false);
  pilot.set_failsafe(true);
  frame = frame_at(pilot, ms(40));
  EXPECT_FALSE(frame.frame_lost);
  EXPECT_TRUE(frame.failsafe);
  EXPECT_EQ(frame.channels[2], 0.4F);
  pilot.set_failsafe(false);
  EXPECT_EQ(frame_at(pilot, ms(60)).channels[2], 0.9F);
}

TEST(Pilot, ScriptedFlagsBeginAndEnd) {
  Script script;
  script.events = {{.at = ms(20), .kind = Event::Kind::kFrameLost},
                   {.at = ms(40), .kind = Event::Kind::kFrameLost, .begins = false},
                   {.at = ms(40), .kind = Event::Kind::kFailsafe},
                   {.at = ms(60), .kind = Event::Kind::kFailsafe, .begins = false}};
  Pilot pilot(std::move(script));
  const std::pair<bool, bool> expected[]{
      {false, false}, {true, false}, {false, true}, {false, false}};
  for (std::int64_t i = 0; i < 4; ++i) {
    const auto frame = frame_at(pilot, ms(20 * i));
    EXPECT_EQ(std::make_pair(frame.frame_lost, frame.failsafe), expected[i]) << i;
  }
}

TEST(Pilot, CentersSticksAndLeavesSwitches) {
  Pilot pilot;
  for (const Control c :
       {Control::kRoll, Control::kPitch, Control::kThrottle, Control::kYaw, Control::kArm}) {
    pilot.set(c, 1.0F);
  }
  frame_at(pilot, ms(0));
  pilot.center_sticks();
  const auto frame = frame_at(pilot, ms(20));
  EXPECT_EQ(frame.channels[0], 0.5F);
  EXPECT_EQ(frame.channels[1], 0.5F);
  EXPECT_EQ(frame.channels[2], 0.0F);
  EXPECT_EQ(frame.channels[3], 0.5F);
  EXPECT_EQ(frame.channels[4], 1.0F);
}

}  // namespace
}  // namespace rosflight::sim::rc
