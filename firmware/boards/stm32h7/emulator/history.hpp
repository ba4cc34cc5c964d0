// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

#include "firmware/hal/time.hpp"

namespace rosflight::boards::stm32h7::emulator {

/// The newest N samples of something, with their times.
template <class Sample, std::size_t N>
class History {
 public:
  struct Entry {
    hal::Time time{};
    Sample sample{};
  };
  /// A moment between two samples: `former` and `later`, which are the same beyond either end.
  struct Place {
    const Entry& former;
    const Entry& later;
    double share;  ///< Part of the way from former to later, 0..1.
  };

  /// Times ascend; a sample of the newest one's time takes its place.
  void put(hal::Time time, const Sample& sample) {
    if (count_ == 0 || time > entry(0).time) ++count_;
    entries_[(count_ - 1) % N] = {time, sample};
  }
  Place at(hal::Time when) const {
    std::size_t back = 0;
    while (back + 1 < std::min(count_, N) && entry(back).time > when) ++back;
    const Entry& former = entry(back);
    const Entry& later = entry(back > 0 && former.time <= when ? back - 1 : back);
    const auto length = static_cast<double>((later.time - former.time).count());
    const double share =
        length > 0.0 ? static_cast<double>((when - former.time).count()) / length : 0.0;
    return {former, later, share};
  }
  /// All zero before the first.
  const Sample& newest() const { return entry(0).sample; }

 private:
  const Entry& entry(std::size_t back) const {
    return entries_[(std::max<std::size_t>(count_, 1) - 1 - back) % N];
  }

  std::array<Entry, N> entries_{};
  std::size_t count_{0};
};

}  // namespace rosflight::boards::stm32h7::emulator
