// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/physics_engine.hpp"

namespace rosflight::sim {

void PhysicsEngine::Contact::add(const Contact& later, double share) {
  wrench.force_B += share * later.wrench.force_B;
  wrench.torque_B += share * later.wrench.torque_B;
  if (!later.touches) return;
  if (!touches || later.approach_m_s > approach_m_s) {
    approach_m_s = later.approach_m_s;
    normal_up = later.normal_up;
    other = later.other;
  }
  touches = true;
  airframe = airframe || later.airframe;
  carries = carries || later.carries;
}

}  // namespace rosflight::sim
