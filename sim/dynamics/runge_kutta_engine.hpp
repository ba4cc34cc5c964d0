// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/dynamics/physics_engine.hpp"
#include "sim/dynamics/rigid_body.hpp"

namespace rosflight::sim {

/// The equations of RigidBody and the scheme of RigidBody, with the load held over a step: behind this interface
/// what coupling alone does to a flight can be measured, without the differences of another program.
class RungeKuttaEngine final : public PhysicsEngine {
 public:
  RungeKuttaEngine(const BodyParameters& body, double gravity_m_s2)
      : mass_kg_{body.mass_kg},
        inertia_{body.inertia_kg_m2},
        inertia_inverse_{body.inertia_kg_m2.inverse()},
        gravity_m_s2_{gravity_m_s2} {}

  void set_state(const BodyState& state) override { state_ = state; }
  void step(double h_s, const Load& load) override;
  const BodyState& state() const override { return state_; }

 private:
  double mass_kg_;
  Matrix3 inertia_;
  Matrix3 inertia_inverse_;
  double gravity_m_s2_;
  BodyState state_;
};

}  // namespace rosflight::sim
