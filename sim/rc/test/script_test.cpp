// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rc/script.hpp"

#include <gtest/gtest.h>

#include <string>

namespace rosflight::sim::rc {
namespace {

Script read(const std::string& text, const ChannelMap& channels = {}) {
  return read_script(config::Document::from_text(text, "rc.yaml").root(), channels);
}

std::string message_of(const std::string& text, const ChannelMap& channels = {}) {
  try {
    static_cast<void>(read(text, channels));
  } catch (const config::Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Script, MayBeEmpty) {
  const Script script = read("{}");
  EXPECT_EQ(script.timing.period, Time{20'000});
  EXPECT_EQ(script.channel_count, 8);
  EXPECT_TRUE(script.events.empty());
  EXPECT_EQ(script.start[0], 0.5F);
  EXPECT_EQ(script.start[2], 0.0F);
}

TEST(Script, ChannelsMayBeMovedAndStarted) {
  const Script script = read(R"(
rate_Hz: 100
channel_count: 10
channels: {roll: 3, yaw: 0, arm: 9, attitude_mode: -1}
start: {throttle: 0.1, arm: 1, channel8: 0.7}
)");
  EXPECT_EQ(script.timing.period, Time{10'000});
  EXPECT_EQ(script.channel_count, 10);
  EXPECT_EQ(script.channels[Control::kRoll], 3);
  EXPECT_EQ(script.channels[Control::kYaw], 0);
  EXPECT_EQ(script.channels[Control::kArm], 9);
  EXPECT_EQ(script.channels[Control::kAttitudeMode], -1);
  EXPECT_EQ(script.channels[Control::kThrottleOverride], 5);
  EXPECT_EQ(script.start[2], 0.1F);
  EXPECT_EQ(script.start[9], 1.0F);
  EXPECT_EQ(script.start[8], 0.7F);
  EXPECT_EQ(script.start[0], 0.5F);
}

TEST(Script, ChannelsOfTheVehicleAreTheDefault) {
  ChannelMap channels;
  channels[Control::kArm] = 6;
  EXPECT_EQ(read("{}", channels).channels[Control::kArm], 6);
  EXPECT_EQ(read("channels: {arm: 4}", channels).channels[Control::kArm], 4);
}

TEST(Script, EventsComeInOrderOfTime) {
  const Script script = read(R"(
events:
  - {at_s: 9, fault: frame_lost, for_s: 2}
  - {at_s: 1, set: throttle, to: 0.3}
  - {at_s: 2.5, ramp: channel2, to: 0.5, over_s: 2}
  - {at_s: 1, switch: arm, on: true}
  - {at_s: 10, switch: arm, on: false}
)");
  ASSERT_EQ(script.events.size(), 6U);
  EXPECT_EQ(script.events[0].at, Time{1'000'000});
  EXPECT_EQ(script.events[0].channel, 2);
  EXPECT_EQ(script.events[0].to, 0.3F);
  EXPECT_EQ(script.events[1].channel, 4);  // the same time: as written
  EXPECT_EQ(script.events[1].to, 1.0F);
  EXPECT_EQ(script.events[2].over, Time{2'000'000});
  EXPECT_EQ(script.events[2].at, Time{2'500'000});
  EXPECT_EQ(script.events[3].kind, Event::Kind::kFrameLost);
  EXPECT_TRUE(script.events[3].begins);
  EXPECT_EQ(script.events[4].to, 0.0F);
  EXPECT_EQ(script.events[5].at, Time{11'000'000});
  EXPECT_FALSE(script.events[5].begins);
}

TEST(Script, ArmingGestureHoldsThrottleDownAndYawRight) {
  // ROSflight 2.x arms by sticks when throttle is low and yaw right for more than 1 s.
  Pilot pilot(
      read("events: [{at_s: 1, gesture: arm}, {at_s: 5, gesture: disarm, for_s: 2}]\nstart: "
           "{throttle: 0.3}"));
  hal::RcFrame frame;
  for (std::int64_t t = 0; t < 8'000'000; t += 20'000) {
    ASSERT_TRUE(pilot.step(Time{t}, frame));
    const bool arming = t >= 1'000'000 && t < 2'500'000;
    const bool disarming = t >= 5'000'000 && t < 7'000'000;
    EXPECT_EQ(frame.channels[3], arming ? 1.0F : disarming ? 0.0F : 0.5F) << t;
    EXPECT_EQ(frame.channels[2], t < 1'000'000 ? 0.3F : 0.0F) << t;
  }
}

TEST(Script, MistakesHaveTheirLineAndWhatIsAllowed) {
  const std::string controls =
      "roll, pitch, throttle, yaw, arm, attitude_override, throttle_override, attitude_mode, "
      "channel0 to channel7";
  EXPECT_EQ(message_of("rate: 50"),
            "rc.yaml:1: rate: found an unknown key, allowed rate_Hz, channel_count, channels, "
            "start, events");
  EXPECT_EQ(message_of("rate_Hz: 70"),
            "rc.yaml:1: rate_Hz: found 70, allowed a rate whose period is a whole "
            "number of microseconds, such as 50");
  EXPECT_EQ(message_of("rate_Hz: fast"),
            "rc.yaml:1: rate_Hz: found fast, allowed a number from 1 to 1000");
  EXPECT_EQ(message_of("channels: {arm: 8}"),
            "rc.yaml:1: channels.arm: found 8, allowed an integer from -1 to 7");
  EXPECT_EQ(message_of("channel_count: 5"),
            "rc.yaml:1: channel_count: found 5, allowed more than 5, the channel "
            "of attitude_override");
  EXPECT_EQ(
      message_of("channels: {gear: 5}"),
      "rc.yaml:1: channels.gear: found an unknown key, allowed roll, pitch, throttle, yaw, arm, "
      "attitude_override, throttle_override, attitude_mode");
  EXPECT_EQ(message_of("start: {flaps: 0.5}"),
            "rc.yaml:1: start.flaps: found an unknown control, allowed " + controls);
  EXPECT_EQ(message_of("start: {yaw: 1.6}"),
            "rc.yaml:1: start.yaw: found 1.6, allowed a number from -0.5 to 1.5");
  EXPECT_EQ(message_of("events:\n  - {at_s: 1}\n"),
            "rc.yaml:2: events.0: found 0 of the words that say what happens, allowed one of set, "
            "ramp, switch, "
            "gesture, fault");
  EXPECT_EQ(message_of("events:\n  - {at_s: 1, set: arm, switch: arm}\n"),
            "rc.yaml:2: events.0: found 2 of the words that say what happens, allowed one of set, "
            "ramp, switch, "
            "gesture, fault");
  EXPECT_EQ(message_of("events:\n  - {at_s: 1, set: flaps, to: 1}\n"),
            "rc.yaml:2: events.0.set: found flaps, allowed " + controls);
  EXPECT_EQ(message_of("events: [{at_s: -1, set: arm, to: 1}]"),
            "rc.yaml:1: events.0.at_s: found -1, allowed a number from 0 to 1e+09");
  EXPECT_EQ(message_of("events: [{set: arm, to: 1}]"),
            "rc.yaml:1: events.0.at_s: found nothing, allowed a number from 0 to 1e+09");
  EXPECT_EQ(message_of("events: [{at_s: 1, set: arm, to: 1, over_s: 2}]"),
            "rc.yaml:1: events.0.over_s: found an unknown key, allowed at_s, set, ramp, "
            "switch, gesture, fault, to");
  EXPECT_EQ(message_of("events: [{at_s: 1, fault: rain, for_s: 1}]"),
            "rc.yaml:1: events.0.fault: found rain, allowed silence, frame_lost, failsafe");
  EXPECT_EQ(message_of("events: {}"), "rc.yaml:1: events: found a map, allowed a list of maps");
  EXPECT_EQ(message_of("events: [5]"), "rc.yaml:1: events.0: found 5, allowed a map");
}

TEST(Script, AControlWithoutAChannelIsAMistake) {
  ChannelMap channels;
  channels[Control::kArm] = -1;
  EXPECT_EQ(message_of("events: [{at_s: 1, switch: arm, on: true}]", channels),
            "rc.yaml:1: events.0.switch: found arm, which has no channel, allowed a control with a "
            "channel");
  EXPECT_EQ(message_of("start: {arm: 1}", channels),
            "rc.yaml:1: start.arm: found a control without a channel, allowed a control with one");
}

}  // namespace
}  // namespace rosflight::sim::rc
