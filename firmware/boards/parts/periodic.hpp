// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/boards/parts/bus.hpp"

namespace rosflight::boards::parts {

/// Due once per period, at the tick that reaches it. Ticks that are missed are not made up for.
class Periodic {
 public:
  explicit Periodic(Time period) : period_{period} {}
  void restart(Time first) { next_ = first; }
  bool due(Time now) {
    if (now < next_) return false;
    next_ += period_;
    if (next_ <= now) next_ = now + period_;
    return true;
  }

 private:
  Time period_;
  Time next_{};
};

}  // namespace rosflight::boards::parts
