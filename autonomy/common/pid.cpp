// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/common/pid.hpp"

#include <cmath>

namespace rosflight::autonomy {

double Pid::step(double desired, double current, double dt_s, Integrate integrate) {
  if (!(dt_s > 0.0) || !std::isfinite(desired) || !std::isfinite(current)) return output_;
  const bool restarted = fresh_ || dt_s > kMaxGap_s;
  if (restarted) {
    derivative_ = 0.0;
  } else {
    const double weight = 1.0 / (2.0 * tau_s_ + dt_s);
    derivative_ =
        weight * ((2.0 * tau_s_ - dt_s) * derivative_ + 2.0 * (current - previous_value_));
  }
  previous_value_ = current;
  return finish(desired - current, derivative_, dt_s, restarted, integrate);
}

void Pid::set_gains(const PidGains& gains) {
  gains_ = gains;
  if (gains_.ki == 0.0) integral_ = 0.0;
}

void Pid::reset() {
  integral_ = previous_error_ = previous_value_ = derivative_ = output_ = 0.0;
  fresh_ = true;
}

}  // namespace rosflight::autonomy
