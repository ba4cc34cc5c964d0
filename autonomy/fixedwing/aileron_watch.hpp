// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// Detects ailerons without effect: a large command, a bank that is far from the wanted one, and no
/// roll rate towards it. Once lost they stay lost until reset(). No clock.
class AileronWatch {
 public:
  /// One step in flight, of dt_s [s].
  /// @param aileron  commanded, -1..1. @param roll_error_rad  wanted less true bank.
  /// @param roll_rate_rad_s  about body x.
  bool step(double aileron, double roll_error_rad, double roll_rate_rad_s, double dt_s) {
    constexpr double kCommand = 0.2;
    constexpr double kError_rad = 7.0 * kRadPerDeg;
    constexpr double kRate_rad_s = 3.0 * kRadPerDeg;
    constexpr double kFor_s = 0.6;
    const double towards = std::copysign(1.0, roll_error_rad);
    const bool no_effect = towards * aileron > kCommand && std::abs(roll_error_rad) > kError_rad &&
                           towards * roll_rate_rad_s < kRate_rad_s;
    since_s_ = no_effect ? since_s_ + dt_s : 0.0;
    lost_ = lost_ || since_s_ > kFor_s;
    return lost_;
  }
  bool lost() const { return lost_; }
  void reset() { *this = {}; }

 private:
  double since_s_{};
  bool lost_{false};
};

}  // namespace rosflight::autonomy::fixedwing
