// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "sim/types.hpp"

namespace rosflight::sim {

/// Moves a rigid body: an integrator of our own, or another program. It knows mass, inertia and gravity of
/// the body; all else that acts on it comes as a load, step by step. RigidBody drives one.
class PhysicsEngine {
 public:
  /// What acts on the body during a step besides gravity, as means over the step. With it the change of
  /// velocity is h (F/m + g), by whatever scheme the engine integrates.
  struct Load {
    Vector3 force_W{Vector3::Zero()};   ///< [N], at the centre of mass.
    Vector3 torque_B{Vector3::Zero()};  ///< About the centre of mass [N m].
  };
  /// What ground and obstacles of the engine's own did in the last step.
  struct Contact {
    bool touches{false};
    Wrench wrench;             ///< On the body, mean over the step.
    bool airframe{false};      ///< More than the gear touches.
    bool carries{false};       ///< A surface within 60 degrees of level touches from below.
    double approach_m_s{0.0};  ///< Fastest approach of a point that touches, before the step.
    double normal_up{0.0};     ///< There: 1 on level ground, 0 at a wall, negative under a roof.
    std::string other;         ///< Name of what it touches there.

    /// Takes in a later contact: what either did, and the speed, normal and name of the faster. @param share  of the
    /// time of this one, for the mean wrench.
    void add(const Contact& later, double share);
  };
  static constexpr double kSteep = 0.5;  ///< Cosine of 60 degrees, for Contact::carries.

  virtual ~PhysicsEngine() = default;
  /// @param state  finite, with a unit quaternion.
  virtual void set_state(const BodyState& state) = 0;
  /// Advances by h_s > 0. @throws std::runtime_error  another program failed: one line that says how.
  virtual void step(double h_s, const Load& load) = 0;
  virtual const BodyState& state() const = 0;
  /// nullptr: the engine has no ground, and that of the vehicle file is part of the load.
  virtual const Contact* contact() const { return nullptr; }
};

}  // namespace rosflight::sim
