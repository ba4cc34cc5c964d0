// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/core/rc.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::core {
namespace {

constexpr std::uint8_t kFirstSwitchChannel = 4;
constexpr float kSwitchHigh = 0.8f;
constexpr float kSwitchLow = 0.2f;
constexpr float kMinValid = -0.25f;
constexpr float kMaxValid = 1.25f;

constexpr std::array<const char*, kSwitchCount> kNames{"arm", "attitude override",
                                                       "throttle override", "attitude type"};

}  // namespace

void Rc::configure(const Config& config) {
  constexpr auto kArm = static_cast<std::size_t>(Switch::kArm);
  const bool same_arm_switch = config.switch_channel[kArm] == config_.switch_channel[kArm] &&
                               config.channel_count == config_.channel_count &&
                               config.direction == config_.direction;
  if (!same_arm_switch) forget_arm_switch();
  const bool same_gesture = same_arm_switch && config.yaw == config_.yaw &&
                            config.throttle == config_.throttle &&
                            config.arm_threshold == config_.arm_threshold;
  if (received_ && !same_gesture) yaw_was_inside_ = false;
  config_ = config;
}

bool Rc::mapped(Switch s) const {
  const std::uint8_t channel = config_.switch_channel[static_cast<std::size_t>(s)];
  return channel >= kFirstSwitchChannel && channel < config_.channel_count;
}

void Rc::describe(Log& log) const {
  for (std::size_t k = 0; k < kSwitchCount; ++k) {
    Text text;
    text.add(kNames[k]).add(" switch ");
    if (mapped(static_cast<Switch>(k))) {
      log.info(text.add("on channel ").add(static_cast<std::int32_t>(config_.switch_channel[k])));
    } else {
      log.info(text.add("not mapped"));
    }
  }
}

bool Rc::good(const hal::RcFrame& frame) const {
  if (frame.frame_lost || frame.failsafe) return false;
  const auto valid = [](float c) { return c >= kMinValid && c <= kMaxValid; };
  const auto delivered = std::min<std::size_t>(frame.channel_count, frame.channels.size());
  const auto n = std::min<std::size_t>(config_.channel_count, delivered);
  const auto& c = frame.channels;
  const auto good_stick = [&](std::uint8_t k) { return k < delivered && valid(c[k]); };
  return std::all_of(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(n), valid) &&
         good_stick(config_.roll) && good_stick(config_.pitch) && good_stick(config_.yaw) &&
         good_stick(config_.throttle);
}

bool Rc::carries(const hal::RcFrame& frame, Switch s) const {
  return mapped(s) && config_.switch_channel[static_cast<std::size_t>(s)] < frame.channel_count;
}

bool Rc::read_switch(const hal::RcFrame& frame, Switch s) const {
  if (!carries(frame, s)) return false;
  const std::uint8_t channel = config_.switch_channel[static_cast<std::size_t>(s)];
  const float c = frame.channels[channel];
  const std::size_t k = channel - kFirstSwitchChannel;
  const bool reversed = k < config_.direction.size() && config_.direction[k] < 0;
  return reversed ? c < kSwitchLow : c >= kSwitchHigh;
}

Rc::Update Rc::step(Time now, const hal::RcFrame* frame, bool may_disarm) {
  Update update;
  const Time since_good = now - last_good_;
  if (frame == nullptr || !good(*frame)) {
    const bool flagged = frame != nullptr && (frame->failsafe || since_good >= kBadFramesUntilLost);
    update.lost = flagged || silent(now);
    return update;
  }
  last_good_ = now;
  update.frame = true;
  update.found = true;
  input_.roll = 2.0f * (frame->channels[config_.roll] - 0.5f);
  input_.pitch = 2.0f * (frame->channels[config_.pitch] - 0.5f);
  input_.yaw = 2.0f * (frame->channels[config_.yaw] - 0.5f);
  input_.throttle = frame->channels[config_.throttle];
  // After boot or an outage the time since the last frame does not count as time in the gesture.
  const bool consecutive = received_ && since_good < kBadFramesUntilLost;
  received_ = true;
  if (shortened(now, *frame)) return update;
  for (std::size_t k = 0; k < kSwitchCount; ++k) {
    input_.on[k] = read_switch(*frame, static_cast<Switch>(k));
  }
  by_switch_ = carries(*frame, Switch::kArm);
  if (!consecutive || !by_switch_) forget_arm_switch();
  if (by_switch_) {
    gesture_ = Time{0};
    look_at_arm_switch(now, update);
  } else {
    look_for_gesture(consecutive ? since_good : Time{0}, may_disarm, update);
  }
  return update;
}

bool Rc::shortened(Time now, const hal::RcFrame& frame) {
  const bool fewer = frame.channel_count < complete_channels_;
  if (fewer && now - complete_ < kBadFramesUntilLost) return true;
  complete_channels_ = frame.channel_count;
  complete_ = now;
  return false;
}

void Rc::look_for_gesture(Time step, bool may_disarm, Update& update) {
  const float outside = 1.0f - config_.arm_threshold;
  yaw_was_inside_ = yaw_was_inside_ || std::abs(input_.yaw) <= outside;
  const bool corner = throttle_low() && (may_disarm ? input_.yaw < -outside : input_.yaw > outside);
  gesture_ = corner && yaw_was_inside_ && step > Time{0} ? gesture_ + step : Time{0};
  if (gesture_ <= kGestureTime) return;
  update.arm = !may_disarm;
  update.disarm = may_disarm;
  if (may_disarm) gesture_ = Time{0};
}

void Rc::look_at_arm_switch(Time now, Update& update) {
  if (input_.is_on(Switch::kArm)) {
    update.arm = arm_switch_was_off_;
    forget_arm_switch();
    return;
  }
  if (off_frames_ == 0) off_since_ = now;
  if (off_frames_ < kOffFrames) ++off_frames_;
  update.disarm = off_frames_ == kOffFrames && now - off_since_ >= kOffTime;
  arm_switch_was_off_ = arm_switch_was_off_ || update.disarm;
}

void Rc::forget_arm_switch() {
  off_frames_ = 0;
  arm_switch_was_off_ = false;
}

}  // namespace rosflight::core
