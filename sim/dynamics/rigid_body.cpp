// SPDX-License-Identifier: BSD-3-Clause
#include "sim/dynamics/rigid_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace rosflight::sim {
namespace {

constexpr std::size_t kBodyStates = 13;  // p, q (w x y z), v, w
constexpr double kMaxStartDepth_m = 0.05;
/// ROSflight 2.x: on the ground below this height.
constexpr double kPlaneReach_m = 0.001;

/// Height given to the module where there is no ground.
constexpr double kNoGround_m = 1e6;

using Array3 = Eigen::Map<Vector3>;
using ConstArray3 = Eigen::Map<const Vector3>;

/// The module's states.
template <class State>
auto module_part(State& y) {
  return std::span(y.data() + kBodyStates, static_cast<std::size_t>(y.size()) - kBodyStates);
}

template <class State>
BodyState unpack(const State& y) {
  BodyState body;
  body.p_W = ConstArray3(y.data());
  body.q_WB = Quaternion(y[3], y[4], y[5], y[6]);
  body.v_B = ConstArray3(y.data() + 7);
  body.w_B = ConstArray3(y.data() + 10);
  return body;
}

template <class State>
void pack(const BodyState& body, State& y) {
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

Eigen::Index checked_size(std::size_t module_states) {
  if (module_states > ForcesAndMoments::kMaxStates) {
    throw std::invalid_argument("a forces-and-moments module with " +
                                std::to_string(module_states) + " states, allowed " +
                                std::to_string(ForcesAndMoments::kMaxStates));
  }
  return static_cast<Eigen::Index>(kBodyStates + module_states);
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
      ground_{ground},
      gravity_m_s2_{environment.gravity_m_s2},
      origin_height_m_{environment.origin.altitude_m},
      atmosphere_{environment.atmosphere},
      wind_{environment.wind, random},
      forces_{forces},
      y_{State::Zero(checked_size(forces.state_size()))} {
  if (ground_model_ == GroundModel::kContact) {
    rest_.p_W.z() = -ground_.rest_height_m(mass_kg_ * gravity_m_s2_);
  }
  begin(rest_);
}

std::span<const double> RigidBody::module_state() const {
  return module_part(y_);
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

double RigidBody::height_m(const BodyState& body) const {
  return ground_model_ == GroundModel::kNone ? kNoGround_m : -body.p_W.z();
}

void RigidBody::begin(const BodyState& given, std::span<const double> module_state) {
  BodyState state = given;
  // A unit quaternion stays as it is to the bit, so that a state that was read can be set again.
  constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
  const double norm = given.q_WB.norm();
  if (std::abs(norm - 1.0) > kRounding) state.q_WB.coeffs() /= norm;
  pack(state, y_);
  forces_.initial_state(module_part(y_));
  std::ranges::copy(module_state, module_part(y_).begin());
  ground_.lift();
  truth_.body = state;
  const AirProperties air = atmosphere_.at(origin_height_m_ - state.p_W.z());
  truth_.air = {air.density_kg_m3, air.pressure_Pa, air.temperature_K, wind_.velocity_W()};
  const hal::OutputValues none{};
  State unused(y_.size());
  derivative(y_, none, unused);
  finish_substep();
  fill_truth(none);
}

void RigidBody::evaluate(const State& y, const BodyState& body, const Matrix3& R_WB,
                         const hal::OutputValues& outputs, State& y_dot) {
  Vector3 v_air_B = Vector3::Zero();
  if (!held_) v_air_B = body.v_B - R_WB.transpose() * truth_.air.wind_W;
  const ForcesAndMoments::Input in{body, R_WB, v_air_B, truth_.air, outputs, height_m(body)};
  forces_.evaluate(in, module_part(y), wrench_, module_part(y_dot));
  total_ = wrench_;
  if (ground_model_ == GroundModel::kContact) {
    if (-body.p_W.z() < ground_.reach_m()) ground_.add_wrench(body, R_WB, total_);
  } else if (ground_model_ == GroundModel::kFrictionlessPlane) {
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

void RigidBody::derivative(const State& y, const hal::OutputValues& outputs, State& y_dot) {
  const BodyState body = unpack(y);
  const Matrix3 R_WB = body.q_WB.toRotationMatrix();
  evaluate(y, body, R_WB, outputs, y_dot);
  const Vector3 a_B = total_.force_B / mass_kg_ + gravity_m_s2_ * R_WB.row(2).transpose();
  angular_acceleration_B_ =
      inertia_inverse_ * (total_.torque_B - body.w_B.cross(inertia_ * body.w_B));
  motion(body, R_WB, a_B, angular_acceleration_B_, y_dot);
}

template <class Derivative>
void RigidBody::runge_kutta(double h, const Derivative& derivative) {
  const Eigen::Index n = y_.size();
  State k1(n);
  State k2(n);
  State k3(n);
  State k4(n);
  State y(n);
  derivative(y_, k1);
  y = y_ + (0.5 * h) * k1;
  derivative(y, k2);
  y = y_ + (0.5 * h) * k2;
  derivative(y, k3);
  y = y_ + h * k3;
  derivative(y, k4);
  y_ += (h / 6.0) * (k1 + 2.0 * (k2 + k3) + k4);
}

void RigidBody::substep(double h, const hal::OutputValues& outputs) {
  runge_kutta(h, [this, &outputs](const State& y, State& y_dot) { derivative(y, outputs, y_dot); });
}

void RigidBody::substep_frozen(double h, const hal::OutputValues& outputs) {
  if (ground_model_ == GroundModel::kFrictionlessPlane) y_[2] = std::min(y_[2], 0.0);
  const BodyState start = unpack(y_);
  const Matrix3 R_start = start.q_WB.toRotationMatrix();
  State module_rate(y_.size());
  evaluate(y_, start, R_start, outputs, module_rate);
  const Vector3 a_B = total_.force_B / mass_kg_ + gravity_m_s2_ * R_start.row(2).transpose();
  runge_kutta(h, [&](const State& y, State& y_dot) {
    const BodyState body = unpack(y);
    angular_acceleration_B_ =
        inertia_inverse_ * (total_.torque_B - body.w_B.cross(inertia_ * body.w_B));
    motion(body, body.q_WB.toRotationMatrix(), a_B, angular_acceleration_B_, y_dot);
    std::ranges::copy(module_part(module_rate), module_part(y_dot).begin());
  });
}

void RigidBody::finish_substep() {
  const double norm = std::sqrt((y_[3] * y_[3] + y_[4] * y_[4]) + (y_[5] * y_[5] + y_[6] * y_[6]));
  y_.segment<4>(3) /= norm;
  forces_.limit_state(module_part(y_));
  truth_.body = unpack(y_);
  const BodyState& body = truth_.body;
  if (ground_model_ == GroundModel::kContact) {
    const bool near = -body.p_W.z() < ground_.reach_m();
    if (near || truth_.on_ground)
      truth_.on_ground = ground_.end_step(body, body.q_WB.toRotationMatrix());
  } else {
    truth_.on_ground =
        ground_model_ == GroundModel::kFrictionlessPlane && body.p_W.z() >= -kPlaneReach_m;
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
  forces_.report(in, module_part(y_), truth_);
}

void RigidBody::step(Time t, const hal::OutputValues& outputs) {
  const double dt = to_seconds(t - truth_.time);
  if (!(dt > 0.0)) return;
  // A step a rounding error longer than allowed is not split.
  const auto count = std::max<std::int64_t>(1, std::llround(std::ceil(dt / max_step_s_ - 1e-9)));
  const double h = dt / static_cast<double>(count);
  for (std::int64_t i = 0; i < count; ++i) {
    const BodyState& body = truth_.body;
    if (!wind_.calm()) {
      const Vector3 v_air_B = body.v_B - body.q_WB.conjugate() * truth_.air.wind_W;
      truth_.air.wind_W = wind_.step(h, -body.p_W.z(), v_air_B.norm());
    }
    if (integration_ == Integration::kRk4) {
      substep(h, outputs);
    } else {
      substep_frozen(h, outputs);
    }
    finish_substep();
  }
  truth_.time = t;
  fill_truth(outputs);
}

}  // namespace rosflight::sim
