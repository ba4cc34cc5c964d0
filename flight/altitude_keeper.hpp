// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <optional>

#include "base/constants.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// A pilot who watches a multirotor and keeps its altitude by the throttle stick:
///
///     stick = carrying (1 + (k (h0 - h) - d climb) / g) / cos(tilt)                             (1)
class AltitudeKeeper {
 public:
  /// Altitude h0 of (1) is that of the next call of stick().
  void set(bool on) {
    on_ = on;
    kept_m_.reset();
  }
  bool on() const { return on_; }

  /// @param carrying  the position that carries the vehicle when it is level. @returns 0.1 to 1.
  double stick(const sim::Truth& truth, double carrying) {
    constexpr double kStiffness_1_s2 = 2.0;
    constexpr double kDamping_1_s = 2.4;
    constexpr double kMinStick = 0.1;
    constexpr double kMinCosine = 0.5;
    const sim::Quaternion& q = truth.body.q_WB;
    const double altitude_m = -truth.body.p_W.z();
    if (!kept_m_) kept_m_ = altitude_m;
    const double climb_m_s = -(q * truth.body.v_B).z();
    const double up_m_s2 = kStiffness_1_s2 * (*kept_m_ - altitude_m) - kDamping_1_s * climb_m_s;
    const double tilt_cosine = std::max((q * sim::Vector3::UnitZ()).z(), kMinCosine);
    return std::clamp(carrying * (1.0 + up_m_s2 / base::kStandardGravity_m_s2) / tilt_cosine,
                      kMinStick, 1.0);
  }

 private:
  bool on_{false};
  std::optional<double> kept_m_;  ///< h0.
};

}  // namespace rosflight::flight
