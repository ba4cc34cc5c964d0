// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <termios.h>
#include <chrono>
#include <optional>

#include "base/file_descriptor.hpp"
#include "rosflight_sim/joystick.hpp"

namespace rosflight_sim {

namespace base = rosflight::base;

/// Sticks and switches moved by keys, as a value: no terminal, no clock of its own.
///
/// | keys  | channel | moves                                                       |
/// |-------|---------|-------------------------------------------------------------|
/// | h, l  | 0       | roll left, right                                            |
/// | k, j  | 1       | pitch forward (nose down), backward                         |
/// | d, f  | 3       | yaw left, right                                             |
/// | a, s  | 2       | throttle up, down, 10 us a stroke                           |
/// | t     | 4       | arm                                                         |
/// | r     | 5       | override                                                    |
/// | m     | 6       | attitude mode: on (angles) at the start                     |
///
/// A terminal reports strokes, not releases: a deflection lasts kFirstHold after the first
/// stroke, as long as a keyboard waits before it repeats, and kHold after a repeated one.
class KeyboardSticks {
 public:
  using Time = std::chrono::milliseconds;
  static constexpr Time kFirstHold{600};
  static constexpr Time kHold{120};

  /// @param deflection  of the attitude sticks, as a part of the whole: 0..1.
  explicit KeyboardSticks(double deflection) : deflection_{deflection} {}

  void stroke(char key, Time now);
  Pulses pulses(Time now) const;
  void flip_arm() { arm_ = !arm_; }
  void flip_override() { override_ = !override_; }

 private:
  struct Stick {
    double value{0.0};
    Time until{0};
  };
  static constexpr int kThrottleStroke_us = 10;

  void push(Stick& stick, double direction, Time now) const;

  double deflection_;
  Stick roll_, pitch_, yaw_;
  int throttle_us_{1000};
  bool arm_{false};
  bool override_{true};
  bool angles_{true};
};

/// Keys of the terminal the program was started from, one by one and without echo. Ctrl-C still
/// ends the program; the terminal is put back when this goes.
class Terminal {
 public:
  /// @returns nothing without a terminal, or in the background of one.
  static std::optional<Terminal> open();
  Terminal(Terminal&&) = default;
  Terminal& operator=(Terminal&&) = delete;
  ~Terminal();

  /// The next key, if one waits.
  std::optional<char> key();

 private:
  Terminal(base::FileDescriptor file, const termios& before)
      : file_{std::move(file)}, before_{before} {}

  base::FileDescriptor file_;
  termios before_;
};

}  // namespace rosflight_sim
