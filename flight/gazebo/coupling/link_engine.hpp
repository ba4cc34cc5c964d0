// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "flight/gazebo/coupling/link_state.hpp"

namespace rosflight::flight::gazebo {

/// The physics engine of a flight whose body a simulator moves: it only passes states on. Its steps have two halves
/// (Flight::begin_step()).
///
/// Contact: what moved the body beside load and gravity,
///
///     f_W = m ((v_1 - v_0)/h - g) - F_W                                  (1)
///
/// It touches from kTouch of its weight on. f is taken for the normal of the surface: the direction up, or its level part if it
/// is steeper than 60 degrees. So friction of a landing gear makes no crash.
class LinkEngine final : public sim::PhysicsEngine {
 public:
  static constexpr double kTouch = 1e-3;

  LinkEngine(double mass_kg, double gravity_m_s2, const sim::Vector3& c_L);

  void set_state(const sim::BodyState& state) override;
  /// @throws std::logic_error  always: the simulator steps.
  void step(double h_s, const Load& load) override;
  const sim::BodyState& state() const override { return state_; }
  const Contact* contact() const override { return &contact_; }

  /// What the simulator must set before it goes on; empty: nothing.
  std::optional<LinkState> take_placing();
  /// The state after that: (1) begins there.
  void begin(const LinkState& link);
  /// The state after h_s under a load.
  void move(const LinkState& link, double h_s, const Load& load);
  const sim::Vector3& centre_of_mass_L() const { return c_L_; }

 private:
  double mass_kg_;
  sim::Vector3 gravity_W_;
  sim::Vector3 c_L_;
  sim::BodyState state_;
  Contact contact_;
  std::optional<LinkState> placing_;
};

}  // namespace rosflight::flight::gazebo
