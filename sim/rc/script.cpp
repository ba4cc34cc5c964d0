// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rc/script.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace rosflight::sim::rc {
namespace {
using config::Range;
using config::Section;

constexpr double kMinRate_Hz = 1.0;
constexpr double kMaxRate_Hz = 1000.0;
constexpr Range kPosition = Range::between(-0.5, 1.5);
constexpr Range kTime_s = Range::between(0.0, 1e9);
constexpr Range kDuration_s = Range::between(1e-6, 1e9);
constexpr double kGesture_s = 1.5;  // the firmware asks for more than 1 s

Time to_time(double seconds) {
  return Time{std::llround(seconds * 1e6)};
}

std::string allowed_controls(int channel_count) {
  std::string out;
  for (const auto name : kControlNames) out += std::string(name) + ", ";
  return out + "channel0 to channel" + std::to_string(channel_count - 1);
}

/// Channel of "arm" or "channel4"; -2 for a word that is neither.
int find_channel(const Script& script, std::string_view name) {
  constexpr std::string_view kChannel = "channel";
  constexpr int kUnknown = -2;
  const auto* const known = std::find(kControlNames.begin(), kControlNames.end(), name);
  if (known != kControlNames.end()) {
    return script.channels.channel[static_cast<std::size_t>(known - kControlNames.begin())];
  }
  if (name.substr(0, kChannel.size()) != kChannel) return kUnknown;
  const std::string_view digits = name.substr(kChannel.size());
  for (int i = 0; i < script.channel_count; ++i) {
    if (digits == std::to_string(i)) return i;
  }
  return kUnknown;
}

int read_control(const Section& in, std::string_view key, const Script& script) {
  const std::string name = in.text(key);
  const int channel = find_channel(script, name);
  if (channel < -1) throw in.error(key, in.raw(key), allowed_controls(script.channel_count));
  if (channel < 0) throw in.error(key, name + ", which has no channel", "a control with a channel");
  return channel;
}

void read_timing(const Section& in, Timing& timing) {
  const double usual_Hz = 1e6 / static_cast<double>(timing.period.count());
  const double rate_Hz = in.number("rate_Hz", Range::between(kMinRate_Hz, kMaxRate_Hz), usual_Hz);
  const double period_us = 1e6 / rate_Hz;
  if (std::abs(period_us - std::round(period_us)) > 1e-9 * period_us) {
    throw in.error("rate_Hz", in.raw("rate_Hz"),
                   "a rate whose period is a whole number of microseconds, such as 50");
  }
  timing.period = Time{std::llround(period_us)};
}

void read_channels(const Section& in, Script& script) {
  script.channel_count = static_cast<int>(
      in.integer("channel_count", 4, hal::RcFrame::kMaxChannels, script.channel_count));
  const auto section = in.optional_section("channels");
  for (std::size_t i = 0; i < kControls; ++i) {
    int& channel = script.channels.channel[i];
    if (section) {
      channel = static_cast<int>(
          section->integer(kControlNames[i], -1, script.channel_count - 1, channel));
    }
    if (channel >= script.channel_count) {
      throw in.error("channel_count", std::to_string(script.channel_count),
                     "more than " + std::to_string(channel) + ", the channel of " +
                         std::string(kControlNames[i]));
    }
  }
}

void read_start(const Section& in, Script& script) {
  const std::array<float, kControls> usual{0.5F, 0.5F, 0.0F, 0.5F};  // switches off
  script.start.fill(0.0F);
  for (std::size_t i = 0; i < kControls; ++i) {
    const int channel = script.channels.channel[i];
    if (channel >= 0) script.start[static_cast<std::size_t>(channel)] = usual[i];
  }
  if (!in.has("start")) return;
  const Section start = in.section("start");
  for (const auto& key : start.keys()) {
    const int channel = find_channel(script, key);
    if (channel < -1) {
      throw start.error(key, "an unknown control", allowed_controls(script.channel_count));
    }
    if (channel < 0) throw start.error(key, "a control without a channel", "a control with one");
    script.start[static_cast<std::size_t>(channel)] =
        static_cast<float>(start.number(key, kPosition));
  }
}

void read_fault(const Section& in, Time at, std::vector<Event>& events) {
  const Section::Choices<Event::Kind> kinds{{"silence", Event::Kind::kSilence},
                                            {"frame_lost", Event::Kind::kFrameLost},
                                            {"failsafe", Event::Kind::kFailsafe}};
  Event event;
  event.kind = in.choice("fault", kinds);
  event.at = at;
  events.push_back(event);
  event.at = at + to_time(in.number("for_s", kDuration_s));
  event.begins = false;
  events.push_back(event);
}

/// Throttle down and yaw to the side that arms or disarms, then yaw back to the middle.
void read_gesture(const Section& in, Time at, const Script& script, std::vector<Event>& events) {
  const float side = in.choice<float>("gesture", {{"arm", 1.0F}, {"disarm", 0.0F}});
  const Time end = at + to_time(in.number("for_s", kDuration_s, kGesture_s));
  const int throttle = script.channels[Control::kThrottle];
  const int yaw = script.channels[Control::kYaw];
  if (throttle < 0 || yaw < 0) {
    throw in.error("gesture", "throttle or yaw without a channel", "both with one");
  }
  const auto move = [&events](Time when, int channel, float to) {
    events.push_back({.at = when, .kind = Event::Kind::kMove, .channel = channel, .to = to});
  };
  move(at, throttle, 0.0F);
  move(at, yaw, side);
  move(end, yaw, 0.5F);
}

void read_event(const Section& in, const Script& script, std::vector<Event>& events) {
  constexpr std::array<std::string_view, 5> kVerbs{"set", "ramp", "switch", "gesture", "fault"};
  const Time at = to_time(in.number("at_s", kTime_s));
  const auto verbs = std::count_if(kVerbs.begin(), kVerbs.end(),
                                   [&in](std::string_view verb) { return in.has(verb); });
  if (verbs != 1) {
    throw in.error(std::to_string(verbs) + " of the words that say what happens",
                   "one of set, ramp, switch, gesture, fault");
  }
  Event event;
  event.at = at;
  if (in.has("set")) {
    event.channel = read_control(in, "set", script);
    event.to = static_cast<float>(in.number("to", kPosition));
  } else if (in.has("ramp")) {
    event.channel = read_control(in, "ramp", script);
    event.to = static_cast<float>(in.number("to", kPosition));
    event.over = to_time(in.number("over_s", kDuration_s));
  } else if (in.has("switch")) {
    event.channel = read_control(in, "switch", script);
    event.to = in.boolean("on") ? 1.0F : 0.0F;
  } else if (in.has("gesture")) {
    return read_gesture(in, at, script, events);
  } else {
    return read_fault(in, at, events);
  }
  events.push_back(event);
}
}  // namespace

Script read_script(const Section& section, const ChannelMap& channels) {
  Script script;
  script.channels = channels;
  read_timing(section, script.timing);
  read_channels(section, script);
  read_start(section, script);
  if (section.has("events")) {
    for (const Section& event : section.sections("events")) {
      read_event(event, script, script.events);
    }
  }
  section.finish();
  std::stable_sort(script.events.begin(), script.events.end(),
                   [](const Event& a, const Event& b) { return a.at < b.at; });
  return script;
}

}  // namespace rosflight::sim::rc
