// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/runge_kutta_engine.hpp"

#include "sim/dynamics/body_motion.hpp"

namespace rosflight::sim {

void RungeKuttaEngine::step(double h_s, const Load& load) {
  using detail::State;
  const Vector3 a_W = load.force_W / mass_kg_ + gravity_m_s2_ * Vector3::UnitZ();
  State y(0);
  detail::pack(state_, y);
  detail::runge_kutta(y, h_s, [&](const State& at, State& y_dot) {
    const BodyState body = detail::unpack(at);
    const Matrix3 R_WB = body.q_WB.toRotationMatrix();
    const Vector3 w_dot = inertia_inverse_ * (load.torque_B - body.w_B.cross(inertia_ * body.w_B));
    detail::motion(body, R_WB, R_WB.transpose() * a_W, w_dot, y_dot);
  });
  detail::normalise_attitude(y);
  state_ = detail::unpack(y);
}

}  // namespace rosflight::sim
