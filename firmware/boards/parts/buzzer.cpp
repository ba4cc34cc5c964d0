// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/parts/buzzer.hpp"

namespace rosflight::boards::parts {
namespace {

struct Pattern {
  std::uint8_t length_10ms;         ///< The whole signal.
  std::uint8_t beep_10ms, on_10ms;  ///< A beep with the silence behind it; without.
  std::uint8_t tone_10us;           ///< Period of the tone.
};
/// In the order of Signal. Without a signal there is always time for the next one.
constexpr Pattern kPatterns[] = {{0, 1, 0, 0},     {60, 20, 10, 50},   {50, 50, 50, 40},
                                 {40, 20, 10, 40}, {100, 100, 50, 25}, {100, 100, 10, 25}};

}  // namespace

std::uint32_t Buzzer::step(const Inputs& in, hal::Time now) {
  constexpr std::uint32_t k10Milliseconds = 10'000, k10Microseconds = 10;
  const auto now_us = static_cast<std::uint32_t>(now.count());
  const auto pattern = [this]() -> const Pattern& {
    return kPatterns[static_cast<unsigned>(signal_)];
  };
  const auto since = [this, now_us] { return (now_us - begin_us_) / k10Milliseconds; };
  const Seen seen = in.armed ? Seen::kArmed : Seen::kDisarmed;
  if (seen != seen_) {
    if (seen_ != Seen::kNothing) {
      signal_ = in.armed ? Signal::kArmed : Signal::kDisarmed;
    } else if (in.after_fault) {
      signal_ = Signal::kStart;
    }
    seen_ = seen;
    begin_us_ = now_us;
  } else if (since() >= pattern().length_10ms) {
    signal_ = Signal::kNone;
    if (in.armed && in.battery_low) signal_ = Signal::kBatteryLow;
    if (in.armed && in.failsafe) signal_ = Signal::kFailsafe;
    begin_us_ = now_us;
  }
  const bool on = since() % pattern().beep_10ms < pattern().on_10ms;
  return on ? k10Microseconds * pattern().tone_10us : 0;
}

}  // namespace rosflight::boards::parts
