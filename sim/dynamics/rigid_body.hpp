// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>

#include "sim/dynamics/body_motion.hpp"
#include "sim/dynamics/ground_contact.hpp"
#include "sim/dynamics/physics_engine.hpp"
#include "sim/environment/environment.hpp"
#include "sim/modules.hpp"

namespace rosflight::sim {

enum class Integration {
  kRk4,          ///< Everything inside the right-hand side.
  kFrozenForces  ///< ROSflight 2.x: all forces held over the step at their value at its start.
};

/// Section `body` of a vehicle file.
struct BodyParameters {
  double mass_kg{};
  /// Matrix J about the centre of mass, as it stands in tau = J dw/dt + w x J w: its off-diagonal
  /// elements are minus the products of inertia, J_xz = -integral x z dm. (ROSflight 2.x's
  /// parameters Jxy, Jxz, Jyz are these matrix elements too.)
  Matrix3 inertia_kg_m2{Matrix3::Identity()};
  Vector3 centre_of_mass_B{Vector3::Zero()};  ///< From the origin of the file's positions [m].
  Integration integration{Integration::kRk4};
  double max_step_s{0.0025};  ///< Longer steps are split evenly.
};

/// `body.center_of_mass_m` of a vehicle file: where the mass is centred, in the axes that all other positions of
/// the file count in. Zero if it is absent.
Vector3 centre_of_mass(const config::Section& vehicle);

/// Reads section `body`: mass, inertia that a body can have (positive, each principal moment at
/// most the sum of the others and 2 %), integration. Throws config::Error.
BodyParameters read_body(const config::Section& section);

/// Motion of one rigid body with the states x of its forces-and-moments module:
///
///     dp/dt = R v                    dv/dt = f/m + R^T g - w x v
///     dq/dt = q (0, w)/2             dw/dt = J^-1 (tau - w x J w)              dx/dt = module
///
/// (R. Beard, T. McLain, "Small Unmanned Aircraft", 2012, eq. 3.14-3.17 with quaternions, app. B).
/// Forces, gravity and ground contact are evaluated at each of the four stages of the classical
/// Runge-Kutta scheme; afterwards the quaternion is normalised. Held over a step: outputs, air (at
/// its start) and wind. Steps longer than max_step_s are split, so a pause never becomes one long
/// step. No heap while stepping.
///
/// Truth: specific force and angular acceleration are those of the last stage, whose state differs
/// from the new one by O(h^3). Contacts with ground of an engine's own, which may push in one substep alone, are in both as
/// their mean over the step.
class RigidBody final : public Dynamics {
 public:
  /// Starts level, nose north, at rest on the ground at the origin (without ground: at the origin).
  /// @param forces  must outlive this.
  RigidBody(const BodyParameters& body, const GroundParameters& ground,
            const EnvironmentParameters& environment, const ForcesAndMoments& forces,
            const RandomSource& random);

  void step(Time t, const hal::OutputValues& outputs) override;
  const Truth& truth() const override { return truth_; }
  /// Also false if a point of the gear would be more than 5 cm under ground.
  bool set_state(const BodyState& state) override;
  /// The same with the states of the module; also false if their number is wrong or one is NaN.
  bool set_state(const BodyState& state, std::span<const double> module_state);

  /// From now on `engine`, which must outlive this, moves the body from where it is. The scheme above then finds the
  /// states of the module, and the load of each step: its mean over the four stages. Ground of the engine's own
  /// takes the place of that of the parameters. @throws config::Error  forces are frozen.
  void set_engine(PhysicsEngine& engine);

  /// step() in two halves, for an engine that another program moves in between: the load of the step to t, at most
  /// max_step_s long; then the state of the engine is that at t. Nothing else is called between them.
  /// @throws std::logic_error  there is no engine, the step is empty or too long.
  PhysicsEngine::Load begin_step(Time t, const hal::OutputValues& outputs);
  /// The second half: takes over the state that the engine reached.
  void end_step(Time t, const hal::OutputValues& outputs);

  /// Contacts with ground of the engine's own since the last call, as one, so that none is missed between two calls; its
  /// wrench is zero. nullopt: no such ground.
  std::optional<PhysicsEngine::Contact> take_contact();

  /// From now on `external`, which must outlive this, changes each wrench of the module; nullptr: nobody does.
  void set_external_wrench(ExternalWrench* external) { external_ = external; }

  /// The vehicle is held, as before a take-off in wind: all forces and torques but gravity are
  /// balanced, so a vehicle at rest stays at rest, and the wind turns no propeller. On ground of an engine's own, which pushes
  /// out what overlaps with it, it is put back after each step and at rest.
  void set_held(bool held) { held_ = held; }

  /// Same as Wind::set(), from the next step on.
  void set_wind(const Vector3& steady_W_m_s, double w20_m_s, const RandomSource& random) {
    wind_.set(steady_W_m_s, w20_m_s, random);
    truth_.air.wind_W = wind_.velocity_W();
  }
  /// As Wind::add_gust().
  void add_gust(const Vector3& peak_W_m_s, double duration_s) {
    wind_.add_gust(peak_W_m_s, duration_s);
  }

  /// The state after construction.
  const BodyState& rest_state() const { return rest_; }
  /// States of the forces-and-moments module.
  std::span<const double> module_state() const;

 private:
  using State = detail::State;

  /// Wrenches at y (into wrench_ and total_) and the module's derivatives.
  void evaluate(const State& y, const BodyState& body, const Matrix3& R_WB,
                const hal::OutputValues& outputs, State& y_dot);
  void derivative(const State& y, const hal::OutputValues& outputs, State& y_dot);
  void stop_fall(const BodyState& body, const Matrix3& R_WB);
  void substep(double h, const hal::OutputValues& outputs);
  PhysicsEngine::Load find_load(double h, const hal::OutputValues& outputs);
  void take_engine_state(double share_of_step);
  void step_wind(double h);
  void substep_frozen(double h, const hal::OutputValues& outputs);
  void finish_substep();
  void finish_step(Time t, const hal::OutputValues& outputs);
  void fill_truth(const hal::OutputValues& outputs);
  bool own_ground() const { return engine_ != nullptr && engine_->contact() != nullptr; }
  bool possible(const BodyState& state) const;
  void begin(const BodyState& state, std::span<const double> module_state = {});
  double height_m(const BodyState& body) const;

  double mass_kg_;
  Matrix3 inertia_;
  Matrix3 inertia_inverse_;
  Integration integration_;
  double max_step_s_;
  GroundModel ground_model_;
  GroundModel acting_ground_;  ///< None where the engine has its own.
  GroundContact ground_;
  double gravity_m_s2_;
  double origin_height_m_;
  Atmosphere atmosphere_;
  Wind wind_;
  const ForcesAndMoments& forces_;
  PhysicsEngine* engine_{nullptr};  ///< nullptr: the body is integrated here.
  ExternalWrench* external_{nullptr};
  bool held_{false};
  BodyState rest_;
  State y_;        ///< p, q (w x y z), v, w and those of the module.
  Wrench wrench_;  ///< Wrench of the module at the last evaluation, and of external_.
  Wrench total_;   ///< With ground, without gravity.
  PhysicsEngine::Contact
      contact_;  ///< Over the substeps of the step under way, with ground of the engine's own.
  PhysicsEngine::Contact contacts_;                  ///< Since take_contact().
  Vector3 angular_acceleration_B_{Vector3::Zero()};  ///< At the last evaluation.
  Truth truth_;
};

}  // namespace rosflight::sim
