// SPDX-License-Identifier: BSD-3-Clause
#include "sim/rc/pilot.hpp"

#include <utility>

namespace rosflight::sim::rc {

Pilot::Pilot(Script script)
    : script_{std::move(script)},
      clock_{script_.timing},
      position_{script_.start},
      last_good_{script_.start} {}

bool Pilot::set(Control control, float to, Time over) {
  return set_channel(script_.channels[control], to, over);
}

bool Pilot::set_channel(int channel, float to, Time over) {
  if (channel < 0 || channel >= script_.channel_count) return false;
  const auto i = static_cast<std::size_t>(channel);
  moves_[i] = {.from = position_[i], .to = to, .start = {}, .over = over, .fresh = true};
  moving_ |= 1U << i;
  return true;
}

void Pilot::center_sticks() {
  for (const Control stick : {Control::kRoll, Control::kPitch, Control::kThrottle, Control::kYaw}) {
    const int channel = script_.channels[stick];
    if (channel >= 0) set_channel(channel, script_.start[static_cast<std::size_t>(channel)]);
  }
}

std::optional<float> Pilot::position(Control control) const {
  const int channel = script_.channels[control];
  if (channel < 0 || channel >= script_.channel_count) return std::nullopt;
  return position_[static_cast<std::size_t>(channel)];
}

void Pilot::handle(const Event& event) {
  switch (event.kind) {
    case Event::Kind::kMove:
      if (set_channel(event.channel, event.to, event.over)) {
        Move& move = moves_[static_cast<std::size_t>(event.channel)];
        move.start = event.at;
        move.fresh = false;
      }
      break;
    case Event::Kind::kSilence:
      silent_ = event.begins;
      break;
    case Event::Kind::kFrameLost:
      frame_lost_ = event.begins;
      break;
    case Event::Kind::kFailsafe:
      failsafe_ = event.begins;
      break;
  }
}

void Pilot::move_channels(Time t) {
  for (std::size_t i = 0; moving_ >> i != 0; ++i) {
    if ((moving_ >> i & 1U) == 0U) continue;
    Move& move = moves_[i];
    if (std::exchange(move.fresh, false)) move.start = t;
    const Time elapsed = t - move.start;
    if (elapsed >= move.over) {
      position_[i] = move.to;
      moving_ &= ~(1U << i);
    } else {
      const auto part = static_cast<float>(elapsed.count()) / static_cast<float>(move.over.count());
      position_[i] = move.from + (move.to - move.from) * part;
    }
  }
}

bool Pilot::step(Time t, hal::RcFrame& frame) {
  if (!clock_.due(t)) return false;
  while (next_event_ < script_.events.size() && script_.events[next_event_].at <= t) {
    const Event& event = script_.events[next_event_++];
    move_channels(event.at);  // so that a ramp starts from where the channel is then
    handle(event);
  }
  move_channels(t);
  if (silent_) return false;
  if (!frame_lost_ && !failsafe_) last_good_ = position_;
  frame.stamp = t;
  frame.channels = last_good_;
  frame.channel_count = static_cast<std::uint8_t>(script_.channel_count);
  frame.frame_lost = frame_lost_;
  frame.failsafe = failsafe_;
  return true;
}

}  // namespace rosflight::sim::rc
