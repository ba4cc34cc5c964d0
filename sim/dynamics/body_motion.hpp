// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "sim/lanes.hpp"
#include "sim/modules.hpp"
#include "sim/types.hpp"

/// The motion of a rigid body as a state vector y that begins with p, q (w x y z), v, w; and the scheme that
/// integrates it. Private to this folder.
namespace rosflight::sim::detail {

/// States of a body and of its forces-and-moments module, in place, in fours: p, q (w x y z), v, w and three zeros, then those
/// of the module and zeros.
class State {
 public:
  /// Numbers of the body that follow are any. @param module_states  at most ForcesAndMoments::kMaxStates.
  explicit State(std::size_t module_states)
      : module_states_{module_states},
        fours_{kBodyFours + (module_states + Lanes::kCount - 1) / Lanes::kCount} {
    y_[kBodyFours - 1] = 0.0;
    y_[fours_ - 1] = 0.0;
  }

  std::size_t fours() const { return fours_; }
  Lanes& four(std::size_t i) { return y_[i]; }
  const Lanes& four(std::size_t i) const { return y_[i]; }
  std::size_t module_states() const { return module_states_; }
  std::span<double> module() { return {data() + kModuleBegins, module_states_}; }
  std::span<const double> module() const { return {data() + kModuleBegins, module_states_}; }
  // A vector type may lie over numbers of its kind.
  double* data() { return reinterpret_cast<double*>(y_.data()); }
  const double* data() const { return reinterpret_cast<const double*>(y_.data()); }
  double& operator[](std::size_t i) { return data()[i]; }
  double operator[](std::size_t i) const { return data()[i]; }

 private:
  static constexpr std::size_t kBodyFours = 4;
  static constexpr std::size_t kModuleBegins = kBodyFours * Lanes::kCount;
  static constexpr std::size_t kMaxFours =
      kBodyFours + ForcesAndMoments::kMaxStates / Lanes::kCount;

  std::size_t module_states_;
  std::size_t fours_;
  std::array<Lanes, kMaxFours> y_;
};

ROSFLIGHT_INLINE BodyState unpack(const State& y) {
  using ConstArray3 = Eigen::Map<const Vector3>;
  BodyState body;
  body.p_W = ConstArray3(y.data());
  body.q_WB = Quaternion(y[3], y[4], y[5], y[6]);
  body.v_B = ConstArray3(y.data() + 7);
  body.w_B = ConstArray3(y.data() + 10);
  return body;
}

ROSFLIGHT_INLINE void pack(const BodyState& body, State& y) {
  using Array3 = Eigen::Map<Vector3>;
  Array3(y.data()) = body.p_W;
  y[3] = body.q_WB.w();
  y[4] = body.q_WB.x();
  y[5] = body.q_WB.y();
  y[6] = body.q_WB.z();
  Array3(y.data() + 7) = body.v_B;
  Array3(y.data() + 10) = body.w_B;
}

/// Derivatives of p, q, v from acceleration a_B (gravity included), and of w as given. From registers in fours: the
/// processor would wait for single numbers to arrive in memory before it loads four of them.
ROSFLIGHT_INLINE void motion(const BodyState& body, const Matrix3& R_WB, const Vector3& a_B,
                             const Vector3& w_dot, State& y_dot) {
  const Vector3& w = body.w_B;
  const Quaternion& q = body.q_WB;
  const Vector3 p_dot = R_WB * body.v_B;
  const Vector3 v_dot = a_B - w.cross(body.v_B);
  y_dot.four(0) = Lanes(p_dot.x(), p_dot.y(), p_dot.z(),
                        0.5 * (-q.x() * w.x() - q.y() * w.y() - q.z() * w.z()));
  y_dot.four(1) = Lanes(0.5 * (q.w() * w.x() + q.y() * w.z() - q.z() * w.y()),
                        0.5 * (q.w() * w.y() + q.z() * w.x() - q.x() * w.z()),
                        0.5 * (q.w() * w.z() + q.x() * w.y() - q.y() * w.x()), v_dot.x());
  y_dot.four(2) = Lanes(v_dot.y(), v_dot.z(), w_dot.x(), w_dot.y());
  y_dot.four(3) = Lanes(w_dot.z(), 0.0, 0.0, 0.0);
}

inline void normalise_attitude(State& y) {
  const double norm = std::sqrt((y[3] * y[3] + y[4] * y[4]) + (y[5] * y[5] + y[6] * y[6]));
  for (std::size_t i = 3; i < 7; ++i) y[i] /= norm;
}

/// One step of the classical scheme. @param derivative  (y, y_dot), called four times.
template <class Derivative>
ROSFLIGHT_INLINE void runge_kutta(State& y_at, double h, const Derivative& derivative) {
  const std::size_t n = y_at.module_states();
  State k1(n);
  State k2(n);
  State k3(n);
  State k4(n);
  State y(n);
  const auto go = [&y, &y_at](double time, const State& k) {
    for (std::size_t i = 0; i < y.fours(); ++i) y.four(i) = y_at.four(i) + time * k.four(i);
  };
  derivative(y_at, k1);
  go(0.5 * h, k1);
  derivative(y, k2);
  go(0.5 * h, k2);
  derivative(y, k3);
  go(h, k3);
  derivative(y, k4);
  for (std::size_t i = 0; i < y.fours(); ++i) {
    const Lanes middle = 2.0 * (k2.four(i) + k3.four(i));
    y_at.four(i) = y_at.four(i) + (h / 6.0) * (k1.four(i) + middle + k4.four(i));
  }
}

/// Shares of the four stages in a mean over the step.
inline constexpr std::array<double, 4> kStageShares{1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

}  // namespace rosflight::sim::detail
