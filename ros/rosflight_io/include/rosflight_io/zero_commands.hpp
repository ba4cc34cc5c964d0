// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>

#include "companion/time.hpp"
#include "link/messages.hpp"

namespace rosflight_io {

/// Counts pass-through commands without any force or torque among those of a flight.
///
/// Such a command stops every motor for as long as it holds. A controller that sends an empty message now and then flies
/// badly, and no other message gives the reason. A vehicle counts as flying from its first command with a value since it was armed
/// until all commands of 5 s were zero.
class ZeroCommands {
 public:
  static constexpr rosflight::companion::Time kLanded = std::chrono::seconds(5);
  static constexpr rosflight::companion::Time kReturnEvery = std::chrono::seconds(1);

  void set_armed(bool armed) {
    if (!armed) *this = {};
    armed_ = armed;
  }

  /// @returns how many came since the last time that this was not 0; at most once in kReturnEvery.
  int take(const rosflight::link::OffboardControl& command, rosflight::companion::Time now) {
    const bool zero =
        std::all_of(command.u.begin(), command.u.end(), [](float u) { return u == 0.0F; });
    if (armed_ && !zero) flying_until_ = now + kLanded;
    const bool pass_through =
        command.mode == static_cast<std::uint8_t>(rosflight::link::OffboardMode::kPassThrough);
    if (!zero || !pass_through || !flying_until_ || now > *flying_until_) return 0;
    ++count_;
    if (returned_ && now - *returned_ < kReturnEvery) return 0;
    returned_ = now;
    const int count = count_;
    count_ = 0;
    return count;
  }

 private:
  bool armed_{false};
  int count_{0};
  std::optional<rosflight::companion::Time> flying_until_;
  std::optional<rosflight::companion::Time> returned_;
};

}  // namespace rosflight_io
