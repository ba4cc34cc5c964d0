// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fixedwing/fixedwing.hpp"

#include <algorithm>
#include <cmath>

namespace rosflight::sim {
namespace {

/// ROSflight 2.x: no aerodynamics below this airspeed, no thrust below this throttle there.
constexpr double kReferenceLeastSpeed_m_s = 2.0;
constexpr float kReferenceLeastThrottle = 0.01F;

/// Commanded deflection; NaN for an output that is none.
double command_rad(const SurfaceParameters& surface, const hal::OutputValues& outputs) {
  const double value = static_cast<double>(outputs[surface.output]);
  return surface.travel_rad * (2.0 * std::clamp(value, 0.0, 1.0) - 1.0);
}

}  // namespace

FixedWing::FixedWing(const FixedWingParameters& parameters)
    : parameters_{parameters},
      airframe_{parameters.airframe},
      propulsion_{parameters.propulsion},
      propulsion_size_{propulsion_.state_size()},
      stuck_(parameters_.surfaces.size(), false) {}

void FixedWing::initial_state(std::span<double> x) const {
  std::ranges::fill(x, 0.0);
  propulsion_.initial_state(x.first(propulsion_size_));
}

double FixedWing::servo_rad(std::size_t i, const hal::OutputValues& outputs,
                            std::span<const double> x) const {
  if (parameters_.servo_time_constant_s > 0.0) return x[propulsion_size_ + i];
  const double command = command_rad(parameters_.surfaces[i], outputs);
  return std::isnan(command) || stuck_[i] ? 0.0 : command;
}

Deflection FixedWing::deflection(const hal::OutputValues& outputs,
                                 std::span<const double> x) const {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i) {
    sum += servo_rad(i, outputs, x) * parameters_.surfaces[i].effect;
  }
  return {sum.x(), sum.y(), sum.z()};
}

void FixedWing::evaluate(const Input& in, std::span<const double> x, Wrench& wrench,
                         std::span<double> x_dot) const {
  propulsion_.evaluate(in, x.first(propulsion_size_), wrench, x_dot.first(propulsion_size_));
  const double tau = parameters_.servo_time_constant_s;
  const double limit = parameters_.servo_rate_limit_rad_s;
  for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i) {
    const double command = command_rad(parameters_.surfaces[i], in.outputs);
    const double rate = tau > 0.0 ? (command - x[propulsion_size_ + i]) / tau : 0.0;
    x_dot[propulsion_size_ + i] =
        std::isnan(rate) || stuck_[i] ? 0.0 : std::clamp(rate, -limit, limit);
  }

  if (parameters_.airframe.model == AeroModel::kReference &&
      !(in.v_air_B.norm() > kReferenceLeastSpeed_m_s)) {
    const bool runs = std::ranges::any_of(parameters_.propulsion.rotors, [&in](const auto& rotor) {
      return in.outputs[rotor.output] >= kReferenceLeastThrottle;
    });
    if (!runs) wrench.force_B.setZero();
    wrench.torque_B.setZero();
    return;
  }
  airframe_.add_wrench(in.v_air_B, in.body.w_B, in.air.density_kg_m3, deflection(in.outputs, x),
                       wrench, in.height_above_ground_m);
}

void FixedWing::limit_state(std::span<double> x) const {
  propulsion_.limit_state(x.first(propulsion_size_));
}

void FixedWing::report(const Input& in, std::span<const double> x, Truth& truth) const {
  propulsion_.report(in, x.first(propulsion_size_), truth);
  const Deflection now = deflection(in.outputs, x);
  truth.aileron_rad = now.aileron_rad;
  truth.elevator_rad = now.elevator_rad;
  truth.rudder_rad = now.rudder_rad;
}

void FixedWing::set_thrust_factor(std::size_t rotor, double factor) {
  propulsion_.set_thrust_factor(rotor, factor);
}

void FixedWing::set_surface_stuck(std::size_t surface, bool stuck) {
  if (surface < stuck_.size()) stuck_[surface] = stuck;
}

}  // namespace rosflight::sim
