// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "sim/modules.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;

/// Integrates the states of a forces-and-moments module without the rigid body, which another node
/// moves: classical Runge-Kutta with the body held, in steps of at most kMaxStep_s.
class ModuleStates {
 public:
  /// @param module  must outlive this.
  explicit ModuleStates(const sim::ForcesAndMoments& module)
      : module_{module}, size_{module.state_size()} {
    module_.initial_state(states());
  }

  std::span<double> states() { return {x_.data(), size_}; }

  /// Moves on by dt_s and evaluates the wrench there; fills rotors and battery of `truth`. Steps
  /// that go back, and those beyond kGiveUp_s (a pause, the first one), leave the states as they
  /// are.
  void step(const sim::ForcesAndMoments::Input& in, double dt_s, sim::Wrench& wrench,
            sim::Truth& truth) {
    if (dt_s > 0.0 && dt_s < kGiveUp_s) {
      const int count = static_cast<int>(std::ceil(dt_s / kMaxStep_s - 1e-9));
      for (int i = 0; i < count; ++i) runge_kutta(in, dt_s / count);
    }
    States unused{};
    module_.evaluate(in, states(), wrench, {unused.data(), size_});
    module_.report(in, states(), truth);
  }

  static constexpr double kMaxStep_s = 0.0025;
  static constexpr double kGiveUp_s = 0.5;

 private:
  using States = std::array<double, sim::ForcesAndMoments::kMaxStates>;

  void slope(const sim::ForcesAndMoments::Input& in, const States& x, States& x_dot) const {
    sim::Wrench unused;
    module_.evaluate(in, {x.data(), size_}, unused, {x_dot.data(), size_});
  }
  States moved(double h, const States& rate) const {
    States x = x_;
    for (std::size_t i = 0; i < size_; ++i) x[i] += h * rate[i];
    return x;
  }
  void runge_kutta(const sim::ForcesAndMoments::Input& in, double h) {
    States k1{}, k2{}, k3{}, k4{};
    slope(in, x_, k1);
    slope(in, moved(0.5 * h, k1), k2);
    slope(in, moved(0.5 * h, k2), k3);
    slope(in, moved(h, k3), k4);
    for (std::size_t i = 0; i < size_; ++i)
      x_[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
    module_.limit_state(states());
  }

  const sim::ForcesAndMoments& module_;
  std::size_t size_;
  States x_{};
};

}  // namespace rosflight_sim
