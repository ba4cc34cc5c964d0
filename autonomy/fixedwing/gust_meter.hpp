// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// Standard deviation of the gusts along one horizontal axis, from the estimated wind w:
///
///     m <- m + dt/10 s (w - m),   s^2 <- s^2 + dt/20 s (|w - m|^2/2 - s^2)                  (1)
class GustMeter {
 public:
  /// Once a step. A wind that is not known is left out.
  void step(const StateEstimate& state, double dt_s) {
    if (!state.wind_valid || !(dt_s > 0.0)) return;
    const Vector2 wind_m_s = state.wind_W.head<2>();
    if (fresh_) mean_m_s_ = wind_m_s;
    fresh_ = false;
    const Vector2 gust_m_s = wind_m_s - mean_m_s_;
    mean_m_s_ += std::min(dt_s / kMean_s, 1.0) * gust_m_s;
    variance_ += std::min(dt_s / kVariance_s, 1.0) * (0.5 * gust_m_s.squaredNorm() - variance_);
  }
  /// |m|
  double mean_m_s() const { return mean_m_s_.norm(); }
  double sigma_m_s() const { return std::sqrt(variance_); }

 private:
  static constexpr double kMean_s = 10.0;
  static constexpr double kVariance_s = 20.0;
  Vector2 mean_m_s_{Vector2::Zero()};
  double variance_{};
  bool fresh_{true};
};

}  // namespace rosflight::autonomy::fixedwing
