// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "autonomy/common/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// Detects ailerons without effect: a large command, a bank that is far from the wanted one, and a
/// roll rate towards it that is less than a tenth of what this command brings about. Once lost they
/// stay lost until reset(). No clock.
class AileronWatch {
 public:
  /// One step in flight, of dt_s [s].
  /// @param aileron  commanded, -1..1. @param roll_error_rad  wanted less true bank.
  /// @param roll_rate_rad_s  about body x. @param full_rate_rad_s  that of an aileron of 1, at this
  /// airspeed; 0: nothing is ever lost.
  bool step(double aileron, double roll_error_rad, double roll_rate_rad_s, double full_rate_rad_s,
            double dt_s) {
    constexpr double kCommand = 0.2;
    constexpr double kError_rad = 7.0 * kRadPerDeg;
    constexpr double kShare = 0.1;
    constexpr double kFor_s = 0.4;
    const double towards = std::copysign(1.0, roll_error_rad);
    const double command = towards * aileron;
    const bool no_effect = command > kCommand && std::abs(roll_error_rad) > kError_rad &&
                           towards * roll_rate_rad_s < kShare * full_rate_rad_s * command;
    since_s_ = no_effect && full_rate_rad_s > 0.0 ? since_s_ + dt_s : 0.0;
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
