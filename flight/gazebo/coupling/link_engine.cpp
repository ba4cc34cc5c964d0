// SPDX-License-Identifier: BSD-3-Clause
#include "flight/gazebo/coupling/link_engine.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rosflight::flight::gazebo {

LinkEngine::LinkEngine(double mass_kg, double gravity_m_s2, const sim::Vector3& c_L)
    : mass_kg_{mass_kg}, gravity_W_{0.0, 0.0, gravity_m_s2}, c_L_{c_L} {}

void LinkEngine::set_state(const sim::BodyState& state) {
  state_ = state;
  contact_ = {};
  placing_ = link_of(state, c_L_);
}

void LinkEngine::step(double /*h_s*/, const Load& /*load*/) {
  throw std::logic_error("a body that the simulator moves");
}

std::optional<LinkState> LinkEngine::take_placing() {
  return std::exchange(placing_, std::nullopt);
}

void LinkEngine::begin(const LinkState& link) {
  state_ = body_of(link, c_L_, state_.q_WB);
}

void LinkEngine::move(const LinkState& link, double h_s, const Load& load) {
  const sim::Vector3 v_before_W = state_.q_WB * state_.v_B;
  state_ = body_of(link, c_L_, state_.q_WB);
  const sim::Vector3 v_W = state_.q_WB * state_.v_B;
  const sim::Vector3 force_W =
      mass_kg_ * ((v_W - v_before_W) / h_s - gravity_W_) - load.force_W;  // (1)
  contact_ = {};
  contact_.touches = force_W.norm() > kTouch * mass_kg_ * gravity_W_.norm();
  if (!contact_.touches) return;
  contact_.wrench.force_B = state_.q_WB.conjugate() * force_W;
  contact_.other = "the world";
  contact_.normal_up = -force_W.normalized().z();
  const bool steep = contact_.normal_up < kSteep;
  contact_.carries = !steep;
  const sim::Vector3 level_W(force_W.x(), force_W.y(), 0.0);
  const sim::Vector3 normal_W = steep && level_W.norm() > 0.0 ? sim::Vector3(level_W.normalized())
                                                              : sim::Vector3(0.0, 0.0, -1.0);
  contact_.approach_m_s = std::max(0.0, -v_before_W.dot(normal_W));
}

}  // namespace rosflight::flight::gazebo
