// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <utility>

#include "firmware/hal/time.hpp"
#include "rosflight_sim/topic_pace.hpp"

namespace rosflight_sim {

namespace hal = rosflight::hal;

/// Time of the simulated board where there is no simulated time: the steady clock, which stands still while the world does.
///
/// On a busy machine IMU samples and frames of the receiver come late. A board whose time ran on would report a
/// broken IMU or a lost receiver; here its time runs at most kLead past the last of each, and past the start before the first of
/// each. What does not come at all is a fault again after kGiveUp, and after kStart at the start. Not thread-safe.
class WaitingClock {
 public:
  using Wall = Overdue::Wall;
  enum class Source : std::uint8_t { kImu, kReceiver };
  static constexpr std::size_t kSources = 2;
  static constexpr std::chrono::milliseconds kGiveUp{500};
  static constexpr std::chrono::milliseconds kStart{3000};  ///< The other nodes are being made.

  struct Stalls {
    int count;
    hal::Time sum;
  };

  /// Never goes back. Waiting at the start is no stall. @param wall  of the same clock at all calls.
  hal::Time at(Wall::time_point wall) {
    hal::Time time = steady(wall) - lost_;
    hal::Time limit = time;
    bool starting = false;
    if (!std::exchange(begun_, true))
      for (Waited& source : sources_) source.last = time;
    for (std::size_t i = 0; i < kSources; ++i) {
      Waited& source = sources_[i];
      const bool late = time > source.last + kLead[i];
      if (!source.counts || (source.came && !late)) continue;
      source.counts = !source.overdue.give_up(wall, source.came ? kGiveUp : kStart);
      starting = starting || (source.counts && !source.came);
      if (source.counts && late) limit = std::min(limit, source.last + kLead[i]);
    }
    limit = std::max(limit, latest_);
    const bool standing = time > limit;
    if (standing) {
      stalls_.count += standing_ || starting ? 0 : 1;
      stalls_.sum += starting ? hal::Time{0} : time - limit;
      lost_ += time - limit;
      time = limit;
    }
    standing_ = standing;
    latest_ = time;
    return time;
  }

  /// A sample or frame has come.
  void came(Source from, Wall::time_point wall) {
    Waited& source = sources_[static_cast<std::size_t>(from)];
    source.last = at(wall);
    source.overdue.none();
    source.counts = source.came = true;
  }

  /// Stalls since the last call.
  Stalls take_stalls() { return std::exchange(stalls_, {}); }

 private:
  /// Several periods of each, and less than the firmware's own limits.
  static constexpr std::array<hal::Time, kSources> kLead{hal::milliseconds(20),
                                                         hal::milliseconds(60)};

  struct Waited {
    hal::Time last{};
    Overdue overdue;
    bool counts{true};
    bool came{false};
  };

  static hal::Time steady(Wall::time_point wall) {
    return std::chrono::duration_cast<hal::Time>(wall.time_since_epoch());
  }

  std::array<Waited, kSources> sources_;
  hal::Time lost_{};
  hal::Time latest_{};
  bool begun_{false};
  bool standing_{false};
  Stalls stalls_{};
};

}  // namespace rosflight_sim
