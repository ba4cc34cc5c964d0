// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>

#include "autonomy/multirotor/controller.hpp"

namespace rosflight::autonomy::multirotor {

/// Finds that a vehicle does not do what its thrust should make it do: it keeps climbing with much less than its weight, or
/// sinking with much more.
///
/// With kLittle of its weight a vehicle loses 3.9 m/s of climb in a second, so one that still climbs at kSpeed_m_s after
/// kClimbing_s is not the vehicle of the settings: motor model, mass or propellers are others. One that sinks for kSinking_s
/// with kMuch of its weight, or with all it has, is too heavy, or something broke.
class ThrustWatch {
 public:
  static constexpr double kSpeed_m_s = 0.5;
  static constexpr double kLittle = 0.6;
  static constexpr double kClimbing_s = 1.5;
  static constexpr double kMuch = 1.5;
  static constexpr double kSinking_s = 4.0;

  /// Once a step. @param thrust_N  commanded. @param down_m_s  of the state. @returns true once, until reset().
  bool step(double thrust_N, double down_m_s, double dt_s, const ControllerConfig& config) {
    const double weight_N = config.mass_kg * config.gravity_m_s2;
    const double high_thrust_N =
        std::min(kMuch * weight_N, config.max_thrust_N * (1.0 - kRounding));
    climbing_s_ =
        thrust_N <= kLittle * weight_N && down_m_s < -kSpeed_m_s ? climbing_s_ + dt_s : 0.0;
    sinking_s_ = thrust_N >= high_thrust_N && down_m_s > kSpeed_m_s ? sinking_s_ + dt_s : 0.0;
    const bool first = !found_ && (climbing_s_ > kClimbing_s || sinking_s_ > kSinking_s);
    found_ = found_ || first;
    return first;
  }
  /// Somebody else flies: what was seen so far does not count.
  void interrupt() { climbing_s_ = sinking_s_ = 0.0; }
  bool found() const { return found_; }
  void reset() { *this = ThrustWatch{}; }

 private:
  static constexpr double kRounding = 1e-3;

  double climbing_s_{};
  double sinking_s_{};
  bool found_{false};
};

}  // namespace rosflight::autonomy::multirotor
