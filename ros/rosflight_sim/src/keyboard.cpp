// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/keyboard.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace rosflight_sim {

namespace base = rosflight::base;

void KeyboardSticks::push(Stick& stick, double direction, Time now) const {
  const bool repeated = now < stick.until && stick.value * direction > 0.0;
  stick.value = direction * deflection_;
  stick.until = std::max(repeated ? stick.until : Time{0}, now + (repeated ? kHold : kFirstHold));
}

void KeyboardSticks::stroke(char key, Time now) {
  constexpr int kMinPulse_us = 1000;
  constexpr int kMaxPulse_us = 2000;
  switch (key) {
    case 'h':
      return push(roll_, -1.0, now);
    case 'l':
      return push(roll_, 1.0, now);
    case 'k':
      return push(pitch_, -1.0, now);
    case 'j':
      return push(pitch_, 1.0, now);
    case 'd':
      return push(yaw_, -1.0, now);
    case 'f':
      return push(yaw_, 1.0, now);
    case 'a':
      throttle_us_ = std::min(throttle_us_ + kThrottleStroke_us, kMaxPulse_us);
      return;
    case 's':
      throttle_us_ = std::max(throttle_us_ - kThrottleStroke_us, kMinPulse_us);
      return;
    case 't':
      return flip_arm();
    case 'r':
      return flip_override();
    case 'm':
      angles_ = !angles_;
      return;
    default:
      return;
  }
}

Pulses KeyboardSticks::pulses(Time now) const {
  const auto stick = [now](const Stick& s) {
    constexpr double kMiddle_us = 1500.0;
    constexpr double kHalfSpan_us = 500.0;
    return static_cast<std::uint16_t>(
        std::lround(kMiddle_us + (now < s.until ? kHalfSpan_us * s.value : 0.0)));
  };
  const auto two_way = [](bool on) { return static_cast<std::uint16_t>(on ? 2000 : 1000); };
  return {stick(roll_),     stick(pitch_), static_cast<std::uint16_t>(throttle_us_),
          stick(yaw_),      two_way(arm_), two_way(override_),
          two_way(angles_), 1500};
}

std::optional<Terminal> Terminal::open() {
  base::FileDescriptor file{::open("/dev/tty", O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)};
  termios before{};
  if (!file.valid() || ::tcgetpgrp(file.get()) != ::getpgrp()) return std::nullopt;
  if (::tcgetattr(file.get(), &before) != 0) return std::nullopt;
  termios raw = before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  if (::tcsetattr(file.get(), TCSANOW, &raw) != 0) return std::nullopt;
  return Terminal{std::move(file), before};
}

Terminal::~Terminal() {
  if (file_.valid()) ::tcsetattr(file_.get(), TCSANOW, &before_);
}

std::optional<char> Terminal::key() {
  char key = 0;
  if (::read(file_.get(), &key, 1) != 1) return std::nullopt;
  return key;
}

}  // namespace rosflight_sim
