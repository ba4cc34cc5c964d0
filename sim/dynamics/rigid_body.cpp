// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rosflight::sim {
namespace {

constexpr double kMaxStartDepth_m = 0.05;
/// ROSflight 2.x: on the ground below this height.
constexpr double kPlaneReach_m = 0.001;

constexpr double kTimeRounding_s = 1e-9;

/// Height given to the module where there is no ground.
constexpr double kNoGround_m = 1e6;

using detail::motion;
using detail::pack;
using detail::runge_kutta;
using detail::unpack;

std::size_t checked(std::size_t module_states) {
  if (module_states > ForcesAndMoments::kMaxStates) {
    throw std::invalid_argument("a forces-and-moments module with " +
                                std::to_string(module_states) + " states, allowed " +
                                std::to_string(ForcesAndMoments::kMaxStates));
  }
  return module_states;
}

bool finite(const BodyState& s) {
  return s.p_W.allFinite() && s.q_WB.coeffs().allFinite() && s.v_B.allFinite() && s.w_B.allFinite();
}

}  // namespace

RigidBody::RigidBody(const BodyParameters& body, const GroundParameters& ground,
                     const EnvironmentParameters& environment, const ForcesAndMoments& forces,
                     const RandomSource& random)
    : mass_kg_{body.mass_kg},
      inertia_{body.inertia_kg_m2},
      inertia_inverse_{body.inertia_kg_m2.inverse()},
      integration_{body.integration},
      max_step_s_{body.max_step_s},
      ground_model_{ground.model},
      acting_ground_{ground.model},
      ground_{ground},
      gravity_m_s2_{environment.gravity_m_s2},
      origin_height_m_{environment.origin.altitude_m},
      atmosphere_{environment.atmosphere},
      wind_{environment.wind, random},
      forces_{forces},
      y_{checked(forces.state_size())} {
  if (ground_model_ == GroundModel::kContact) {
    rest_.p_W.z() = -ground_.rest_height_m(mass_kg_ * gravity_m_s2_);
  }
  begin(rest_);
}

std::span<const double> RigidBody::module_state() const {
  return y_.module();
}

bool RigidBody::possible(const BodyState& state) const {
  if (!finite(state) || !(state.q_WB.norm() > 1e-6)) return false;
  if (ground_model_ != GroundModel::kNone && state.p_W.z() > 0.0) return false;
  BodyState unit = state;
  unit.q_WB.coeffs() /= state.q_WB.norm();
  return ground_model_ != GroundModel::kContact || ground_.depth_m(unit) <= kMaxStartDepth_m;
}

bool RigidBody::set_state(const BodyState& state) {
  if (!possible(state)) return false;
  begin(state);
  return true;
}

bool RigidBody::set_state(const BodyState& state, std::span<const double> module_state) {
  const auto number = [](double x) { return std::isfinite(x); };
  if (!possible(state) || module_state.size() != forces_.state_size() ||
      !std::ranges::all_of(module_state, number)) {
    return false;
  }
  begin(state, module_state);
  return true;
}

ROSFLIGHT_INLINE double RigidBody::height_m(const BodyState& body) const {
  return ground_model_ == GroundModel::kNone ? kNoGround_m : -body.p_W.z();
}

void RigidBody::set_engine(PhysicsEngine& engine) {
  if (integration_ != Integration::kRk4)
    throw config::Error("body.integration: found frozen_forces with a physics engine, allowed rk4");
  engine_ = &engine;
  if (engine.contact() != nullptr) acting_ground_ = GroundModel::kNone;
  engine.set_state(truth_.body);
}

void RigidBody::begin(const BodyState& given, std::span<const double> module_state) {
  BodyState state = given;
  // A unit quaternion stays as it is to the bit, so that a state that was read can be set again.
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double norm = given.q_WB.norm();
  if (std::abs(norm - 1.0) > kRounding) state.q_WB.coeffs() /= norm;
  pack(state, y_);
  forces_.initial_state(y_.module());
  std::ranges::copy(module_state, y_.module().begin());
  ground_.lift();
  contact_ = contacts_ = {};
  truth_.body = state;
  const AirProperties air = atmosphere_.at(origin_height_m_ - state.p_W.z());
  truth_.air = {air.density_kg_m3, air.pressure_Pa, air.temperature_K, wind_.velocity_W()};
  const hal::OutputValues none{};
  State unused(y_.module_states());
  derivative(y_, none, unused);
  finish_substep();
  fill_truth(none);
  if (engine_ != nullptr) engine_->set_state(truth_.body);
}

ROSFLIGHT_INLINE void RigidBody::evaluate(const State& y, const BodyState& body,
                                          const Matrix3& R_WB, const hal::OutputValues& outputs,
                                          State& y_dot) {
  Vector3 v_air_B = Vector3::Zero();
  if (!held_) v_air_B = body.v_B - R_WB.transpose() * truth_.air.wind_W;
  const ForcesAndMoments::Input in{body, R_WB, v_air_B, truth_.air, outputs, height_m(body)};
  forces_.evaluate(in, y.module(), wrench_, y_dot.module());
  if (external_ != nullptr) external_->change(in, wrench_);
  total_ = wrench_;
  if (acting_ground_ == GroundModel::kContact) {
    if (-body.p_W.z() < ground_.reach_m()) ground_.add_wrench(body, R_WB, total_);
  } else if (acting_ground_ == GroundModel::kFrictionlessPlane) {
    stop_fall(body, R_WB);
  }
  if (held_) {
    total_.force_B = -mass_kg_ * gravity_m_s2_ * R_WB.row(2).transpose();
    total_.torque_B = body.w_B.cross(inertia_ * body.w_B);
  }
}

void RigidBody::stop_fall(const BodyState& body, const Matrix3& R_WB) {
  if (body.p_W.z() < -kPlaneReach_m) return;
  const double down_N = R_WB.row(2).dot(total_.force_B) + mass_kg_ * gravity_m_s2_;
  if (down_N > 0.0) total_.force_B -= down_N * R_WB.row(2).transpose();
}

ROSFLIGHT_INLINE void RigidBody::derivative(const State& y, const hal::OutputValues& outputs,
                                            State& y_dot) {
  const BodyState body = unpack(y);
  const Matrix3 R_WB = body.q_WB.toRotationMatrix();
  evaluate(y, body, R_WB, outputs, y_dot);
  const Vector3 a_B = total_.force_B / mass_kg_ + gravity_m_s2_ * R_WB.row(2).transpose();
  angular_acceleration_B_ =
      inertia_inverse_ * (total_.torque_B - body.w_B.cross(inertia_ * body.w_B));
  motion(body, R_WB, a_B, angular_acceleration_B_, y_dot);
}

ROSFLIGHT_WIDE void RigidBody::substep(double h, const hal::OutputValues& outputs) {
  runge_kutta(y_, h,
              [this, &outputs](const State& y, State& y_dot) { derivative(y, outputs, y_dot); });
}

/// The engine moves the body under the mean of the load that this scheme meets on the way from the engine's
/// state; the states of the module go that way themselves. An error of second order in h.
PhysicsEngine::Load RigidBody::find_load(double h, const hal::OutputValues& outputs) {
  PhysicsEngine::Load load;
  std::size_t stage = 0;
  runge_kutta(y_, h, [&](const State& y, State& y_dot) {
    derivative(y, outputs, y_dot);
    const double share = detail::kStageShares.at(stage++);
    load.force_W += share * (unpack(y).q_WB.normalized() * total_.force_B);
    load.torque_B += share * total_.torque_B;
  });
  return load;
}

/// What the engine made of the load. Hands that hold the body balance the ground of the engine too.
void RigidBody::take_engine_state(double share_of_step) {
  if (!own_ground()) return pack(engine_->state(), y_);
  contact_.add(*engine_->contact(), held_ ? 0.0 : share_of_step);
  BodyState state = engine_->state();
  if (held_) {
    state = truth_.body;
    state.v_B = state.w_B = Vector3::Zero();
    engine_->set_state(state);
  }
  pack(state, y_);
}

void RigidBody::substep_frozen(double h, const hal::OutputValues& outputs) {
  if (acting_ground_ == GroundModel::kFrictionlessPlane) y_[2] = std::min(y_[2], 0.0);
  const BodyState start = unpack(y_);
  const Matrix3 R_start = start.q_WB.toRotationMatrix();
  State module_rate(y_.module_states());
  evaluate(y_, start, R_start, outputs, module_rate);
  const Vector3 a_B = total_.force_B / mass_kg_ + gravity_m_s2_ * R_start.row(2).transpose();
  runge_kutta(y_, h, [&](const State& y, State& y_dot) {
    const BodyState body = unpack(y);
    angular_acceleration_B_ =
        inertia_inverse_ * (total_.torque_B - body.w_B.cross(inertia_ * body.w_B));
    motion(body, body.q_WB.toRotationMatrix(), a_B, angular_acceleration_B_, y_dot);
    std::ranges::copy(module_rate.module(), y_dot.module().begin());
  });
}

void RigidBody::finish_substep() {
  detail::normalise_attitude(y_);
  forces_.limit_state(y_.module());
  truth_.body = unpack(y_);
  const BodyState& body = truth_.body;
  if (acting_ground_ == GroundModel::kContact) {
    const bool near = -body.p_W.z() < ground_.reach_m();
    if (near || truth_.on_ground)
      truth_.on_ground = ground_.end_step(body, body.q_WB.toRotationMatrix());
  } else {
    truth_.on_ground =
        acting_ground_ == GroundModel::kFrictionlessPlane && body.p_W.z() >= -kPlaneReach_m;
    if (own_ground()) truth_.on_ground = contact_.carries;
  }
}

void RigidBody::fill_truth(const hal::OutputValues& outputs) {
  const BodyState& body = truth_.body;
  truth_.specific_force_B = total_.force_B / mass_kg_;
  truth_.angular_acceleration_B = angular_acceleration_B_;
  truth_.wrench = wrench_;
  const AirProperties air = atmosphere_.at(origin_height_m_ - body.p_W.z());
  truth_.air.density_kg_m3 = air.density_kg_m3;
  truth_.air.pressure_Pa = air.pressure_Pa;
  truth_.air.temperature_K = air.temperature_K;
  const Matrix3 R_WB = body.q_WB.toRotationMatrix();
  const Vector3 v_air_B = body.v_B - R_WB.transpose() * truth_.air.wind_W;
  const ForcesAndMoments::Input in{body, R_WB, v_air_B, truth_.air, outputs, height_m(body)};
  forces_.report(in, y_.module(), truth_);
}

void RigidBody::step_wind(double h) {
  if (wind_.calm()) return;
  const BodyState& body = truth_.body;
  const Vector3 v_air_B = body.v_B - body.q_WB.conjugate() * truth_.air.wind_W;
  truth_.air.wind_W = wind_.step(h, -body.p_W.z(), v_air_B.norm());
}

PhysicsEngine::Load RigidBody::begin_step(Time t, const hal::OutputValues& outputs) {
  const double h = to_seconds(t - truth_.time);
  if (engine_ == nullptr || !(h > 0.0) || h > max_step_s_ + kTimeRounding_s)
    throw std::logic_error("a step in two halves of " + std::to_string(h) +
                           " s, allowed with an engine and up to " + std::to_string(max_step_s_));
  contact_ = {};
  step_wind(h);
  return find_load(h, outputs);
}

void RigidBody::end_step(Time t, const hal::OutputValues& outputs) {
  take_engine_state(1.0);
  finish_substep();
  finish_step(t, outputs);
}

void RigidBody::step(Time t, const hal::OutputValues& outputs) {
  const double dt = to_seconds(t - truth_.time);
  if (!(dt > 0.0)) return;
  // A step a rounding error longer than allowed is not split.
  const double steps = dt / max_step_s_ - 1e-9;
  const std::int64_t count = steps <= 1.0 ? 1 : std::llround(std::ceil(steps));
  const double h = dt / static_cast<double>(count);
  contact_ = {};
  for (std::int64_t i = 0; i < count; ++i) {
    step_wind(h);
    if (engine_ != nullptr) {
      engine_->step(h, find_load(h, outputs));
      take_engine_state(1.0 / static_cast<double>(count));
    } else if (integration_ == Integration::kRk4) {
      substep(h, outputs);
    } else {
      substep_frozen(h, outputs);
    }
    finish_substep();
  }
  finish_step(t, outputs);
}

void RigidBody::finish_step(Time t, const hal::OutputValues& outputs) {
  truth_.time = t;
  if (own_ground()) {
    total_.force_B += contact_.wrench.force_B;
    angular_acceleration_B_ += inertia_inverse_ * contact_.wrench.torque_B;
    contacts_.add(contact_, 0.0);
  }
  fill_truth(outputs);
}

std::optional<PhysicsEngine::Contact> RigidBody::take_contact() {
  if (!own_ground()) return std::nullopt;
  return std::exchange(contacts_, {});
}

}  // namespace rosflight::sim
