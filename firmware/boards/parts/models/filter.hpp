// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cmath>

#include "base/constants.hpp"

namespace rosflight::boards::parts::models {

/// Second-order Butterworth low pass by the bilinear transformation, started at its first input. It is not
/// prewarped: so its group delay for slow signals is exactly that of the continuous filter,
/// sqrt(2) / (2 pi bandwidth), and the bandwidth is lower by 1.4 % at a fifteenth of the sample rate.
class LowPass {
 public:
  void configure(double bandwidth_hz, double sample_hz) {
    const double k = base::kPi * bandwidth_hz / sample_hz;
    const double norm = 1.0 / (1.0 + std::sqrt(2.0) * k + k * k);
    b_ = k * k * norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - std::sqrt(2.0) * k + k * k) * norm;
  }
  double step(double x) {
    if (!started_) {
      // The state that holds this input for ever.
      s2_ = (b_ - a2_) * x;
      s1_ = (1.0 - b_) * x;
      started_ = true;
    }
    const double y = b_ * x + s1_;
    s1_ = 2.0 * b_ * x - a1_ * y + s2_;
    s2_ = b_ * x - a2_ * y;
    return y;
  }
  void reset() { started_ = false; }
  /// Group delay for slow signals, in samples.
  double delay() const { return 1.0 - (a1_ + 2.0 * a2_) / (1.0 + a1_ + a2_); }

 private:
  double b_{1.0}, a1_{}, a2_{};
  double s1_{}, s2_{};
  bool started_{false};
};

}  // namespace rosflight::boards::parts::models
