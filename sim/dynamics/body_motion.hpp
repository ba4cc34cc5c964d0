// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>

#include "sim/types.hpp"

/// The motion of a rigid body as a state vector y that begins with p, q (w x y z), v, w; and the scheme that
/// integrates it. Private to this folder.
namespace rosflight::sim::detail {

inline constexpr std::size_t kBodyStates = 13;

template <class State>
BodyState unpack(const State& y) {
  using ConstArray3 = Eigen::Map<const Vector3>;
  BodyState body;
  body.p_W = ConstArray3(y.data());
  body.q_WB = Quaternion(y[3], y[4], y[5], y[6]);
  body.v_B = ConstArray3(y.data() + 7);
  body.w_B = ConstArray3(y.data() + 10);
  return body;
}

template <class State>
void pack(const BodyState& body, State& y) {
  using Array3 = Eigen::Map<Vector3>;
  Array3(y.data()) = body.p_W;
  y[3] = body.q_WB.w();
  y[4] = body.q_WB.x();
  y[5] = body.q_WB.y();
  y[6] = body.q_WB.z();
  Array3(y.data() + 7) = body.v_B;
  Array3(y.data() + 10) = body.w_B;
}

/// Derivatives of p, q, v from acceleration a_B (gravity included), and of w as given.
template <class State>
void motion(const BodyState& body, const Matrix3& R_WB, const Vector3& a_B, const Vector3& w_dot,
            State& y_dot) {
  using Array3 = Eigen::Map<Vector3>;
  const Vector3& w = body.w_B;
  const Quaternion& q = body.q_WB;
  Array3(y_dot.data()) = R_WB * body.v_B;
  y_dot[3] = 0.5 * (-q.x() * w.x() - q.y() * w.y() - q.z() * w.z());
  y_dot[4] = 0.5 * (q.w() * w.x() + q.y() * w.z() - q.z() * w.y());
  y_dot[5] = 0.5 * (q.w() * w.y() + q.z() * w.x() - q.x() * w.z());
  y_dot[6] = 0.5 * (q.w() * w.z() + q.x() * w.y() - q.y() * w.x());
  Array3(y_dot.data() + 7) = a_B - w.cross(body.v_B);
  Array3(y_dot.data() + 10) = w_dot;
}

template <class State>
void normalise_attitude(State& y) {
  const double norm = std::sqrt((y[3] * y[3] + y[4] * y[4]) + (y[5] * y[5] + y[6] * y[6]));
  y.template segment<4>(3) /= norm;
}

/// One step of the classical scheme. @param derivative  (y, y_dot), called four times.
template <class State, class Derivative>
void runge_kutta(State& y_at, double h, const Derivative& derivative) {
  const Eigen::Index n = y_at.size();
  State k1(n);
  State k2(n);
  State k3(n);
  State k4(n);
  State y(n);
  derivative(y_at, k1);
  y = y_at + (0.5 * h) * k1;
  derivative(y, k2);
  y = y_at + (0.5 * h) * k2;
  derivative(y, k3);
  y = y_at + h * k3;
  derivative(y, k4);
  y_at += (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4);
}

/// Shares of the four stages in a mean over the step.
inline constexpr std::array<double, 4> kStageShares{1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

}  // namespace rosflight::sim::detail
