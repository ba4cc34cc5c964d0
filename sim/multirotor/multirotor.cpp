// SPDX-License-Identifier: BSD-3-Clause
#include "sim/multirotor/multirotor.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/multirotor/inflow.hpp"
#include "sim/portable_math.hpp"

namespace rosflight::sim {
namespace {

constexpr double kTwoPi = 6.283185307179586;
/// Minimum coefficients and rotor speed of ROSflight 2.x.
constexpr double kReferenceFloor = 1e-4;
/// Above this many radii the ground changes thrust by less than 2e-4.
constexpr double kGroundEffectReach = 20.0;

double fourth_power(double x) {
  return x * x * x * x;
}

/// What an ESC makes of a command: 0..1, nothing of a NaN.
double duty_of(float output) {
  return static_cast<double>(std::min(std::max(0.0F, output), 1.0F));
}

ROSFLIGHT_INLINE Lanes dot(const Vector3Lanes& a, const Vector3Lanes& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

void set_lane(Vector3Lanes& lanes, std::size_t k, const Vector3& v) {
  lanes.x.set(k, v.x());
  lanes.y.set(k, v.y());
  lanes.z.set(k, v.z());
}

/// e turned by an angle about a unit axis (O. Rodrigues, 1840).
Vector3 turn(const Vector3& e, const Vector3& axis, double angle_rad) {
  const portable::SinCos a = portable::sin_cos(angle_rad);
  return a.cos * e + a.sin * axis.cross(e) + (1.0 - a.cos) * axis.dot(e) * axis;
}

}  // namespace

Multirotor::Multirotor(const MultirotorParameters& p)
    : group_{},
      rotors_{p.rotors.size()},
      groups_{(rotors_ + kLanes - 1) / kLanes},
      propeller_{p.propeller},
      motor_{p.motor},
      reference_flow_{p.flow == RotorFlow::kReference},
      airspeed_flow_{p.flow == RotorFlow::kAirspeed},
      momentum_{p.inflow == RotorInflow::kMomentum},
      off_centre_{!p.aero.centre_B.isZero(0.0)},
      battery_{p.battery},
      aero_{p.aero},
      thrust_per_density_{fourth_power(p.propeller.diameter_m) / (kTwoPi * kTwoPi)},
      flow_per_speed_{kTwoPi / p.propeller.diameter_m},
      per_resistance_{1.0 / p.motor.resistance_ohm},
      per_inertia_{p.propeller.inertia_kg_m2 > 0.0 ? 1.0 / p.propeller.inertia_kg_m2 : 0.0},
      disc_m2_{0.125 * kTwoPi * p.propeller.diameter_m * p.propeller.diameter_m},
      lift_slope_{
          lift_slope_m3(p.propeller.diameter_m, p.propeller.thrust[0], p.propeller.thrust[1])} {
  if (motor_.model == MotorModel::kInstant) propeller_.inertia_kg_m2 = 0.0;
  const RotorParameters missing;
  for (std::size_t i = 0; i < kGroups * kLanes; ++i) {
    Group& group = group_[i / kLanes];
    const std::size_t k = i % kLanes;
    const bool real = i < rotors_;
    const RotorParameters& r = real ? p.rotors[i] : missing;
    set_lane(group.p_B, k, r.p_B);
    aim(group, k, r.p_B, r.e_B);
    group.spin.set(k, r.spin);
    group.factor.set(k, real ? 1.0 : 0.0);
    group.alive.set(k, real ? 1.0 : 0.0);
    group.output[k] = r.output;
    extent_m_ = std::max(extent_m_, r.p_B.norm());
    if (r.tilt) tilts_.push_back({i, r.p_B, r.e_B, *r.tilt, false});
  }
}

void Multirotor::aim(Group& group, std::size_t lane, const Vector3& p_B, const Vector3& e_B) {
  set_lane(group.e_B, lane, e_B);
  set_lane(group.p_cross_e_B, lane, p_B.cross(e_B));
}

const Multirotor::Groups& Multirotor::directed(std::span<const double> x, Groups& turned) const {
  if (tilts_.empty()) return group_;
  turned = group_;
  for (std::size_t i = 0; i < tilts_.size(); ++i) {
    const Tilt& tilt = tilts_[i];
    aim(turned[tilt.rotor / kLanes], tilt.rotor % kLanes, tilt.p_B,
        turn(tilt.e_B, tilt.servo.axis_B, x[rotors_ + 1 + i]));
  }
  return turned;
}

void Multirotor::initial_state(std::span<double> x) const {
  std::fill(x.begin(), x.end(), 0.0);
  x[rotors_] = battery_.initial_charge_As();
}

void Multirotor::set_thrust_factor(std::size_t rotor, double factor) {
  if (rotor >= rotors_) return;
  Group& group = group_[rotor / kLanes];
  const bool dead = !(factor > 0.0);
  group.alive.set(rotor % kLanes, dead ? 0.0 : 1.0);
  group.factor.set(rotor % kLanes, dead ? 1.0 : std::min(factor, 1.0));
}

void Multirotor::set_surface_stuck(std::size_t surface, bool stuck) {
  if (surface < tilts_.size()) tilts_[surface].stuck = stuck;
}

template <std::size_t kFixed>
ROSFLIGHT_INLINE void Multirotor::load(std::span<const double> x, PerRotor& speed) const {
  if (kFixed == 1 && rotors_ == kLanes) {
    speed[0] = Lanes::load(x.data());
    return;
  }
  for (std::size_t g = 0; g < groups_; ++g) {
    const std::size_t i = g * kLanes;
    const auto at = [x, n = rotors_](std::size_t k) { return k < n ? x[k] : 0.0; };
    speed[g] = Lanes(at(i), at(i + 1), at(i + 2), at(i + 3));
  }
}

template <std::size_t kFixed>
ROSFLIGHT_INLINE void Multirotor::supply(const hal::OutputValues& outputs, const PerRotor& speed,
                                         double charge_As, Supply& now) const {
  const double open_V = battery_.open_circuit_V(charge_As);
  const double k = motor_.torque_constant_Nm_A;
  const double r_b = battery_.resistance_ohm();
  const double own_A = open_V > 0.0 ? battery_.avionics_current_A() : 0.0;
  Lanes duty_sq = 0.0;
  Lanes duty_speed = 0.0;
  for (std::size_t g = 0; g < group_count<kFixed>(); ++g) {
    const auto& output = group_[g].output;
    const Lanes command(duty_of(outputs[output[0]]), duty_of(outputs[output[1]]),
                        duty_of(outputs[output[2]]), duty_of(outputs[output[3]]));
    const Lanes duty = open_V > 0.0 ? command * group_[g].alive : Lanes(0.0);
    duty_sq = duty_sq + duty * duty;
    duty_speed = duty_speed + duty * speed[g];
    now.duty[g] = duty;
  }
  const double terminal_V = (open_V - r_b * (own_A - k * per_resistance_ * sum(duty_speed))) /
                            (1.0 + r_b * per_resistance_ * sum(duty_sq));
  const double least_A = motor_.active_braking ? -motor_.current_limit_A : 0.0;
  Lanes drawn_A = 0.0;
  for (std::size_t g = 0; g < group_count<kFixed>(); ++g) {
    const Lanes duty = now.duty[g];
    const Lanes current = (duty * terminal_V - k * speed[g]) * per_resistance_;
    now.current_A[g] =
        where_positive(duty, min(max(current, least_A), motor_.current_limit_A), 0.0);
    drawn_A = drawn_A + duty * now.current_A[g];
  }
  now.current_sum_A = own_A + sum(drawn_A);
  now.voltage_V = open_V - r_b * now.current_sum_A;
}

ROSFLIGHT_INLINE Vector3Lanes Multirotor::hub_velocity(const Input& in, const Group& group) const {
  const Vector3& v = in.v_air_B;
  const Vector3& w = in.body.w_B;
  const Vector3Lanes& p = group.p_B;
  if (reference_flow_ || airspeed_flow_) return {v.x(), v.y(), v.z()};
  return {v.x() + (w.y() * p.z - w.z() * p.y), v.y() + (w.z() * p.x - w.x() * p.z),
          v.z() + (w.x() * p.y - w.y() * p.x)};
}

ROSFLIGHT_INLINE Lanes Multirotor::inflow(const Input& in, const Group& group,
                                          const Vector3Lanes& hub) const {
  return airspeed_flow_ ? Lanes(in.v_air_B.norm()) : dot(hub, group.e_B);
}

ROSFLIGHT_INLINE Multirotor::Blades Multirotor::blades(const Lanes& speed, const Lanes& u,
                                                       double density, const Lanes& factor) const {
  const auto& ct = propeller_.thrust;
  const auto& cq = propeller_.torque;
  const Lanes upwards = max(u, 0.0);
  const Lanes square = upwards * upwards;
  const Lanes linear = reference_flow_ ? upwards : max(u, -propeller_.descent_limit * speed);
  Lanes thrust = speed * (ct[0] * speed + ct[1] * linear) + ct[2] * square;
  Lanes torque = speed * (cq[0] * speed + cq[1] * linear) + cq[2] * square;
  if (reference_flow_) {
    const Lanes floor = kReferenceFloor * speed * speed;
    thrust = where_positive(thrust, thrust, floor);
    torque = where_positive(torque, torque, floor);
  }
  const Lanes scale = density * thrust_per_density_ * factor;
  return {scale * thrust, scale * propeller_.diameter_m * torque};
}

ROSFLIGHT_INLINE Lanes Multirotor::steady_speed(const Lanes& drive_V, const Lanes& speed,
                                                const Lanes& u, double density,
                                                const Lanes& factor) const {
  const auto& cq = propeller_.torque;
  const double k = motor_.torque_constant_Nm_A;
  const Lanes scale = density * thrust_per_density_ * propeller_.diameter_m * factor;
  const Lanes upwards = max(u, 0.0);
  const Lanes linear = reference_flow_ ? upwards : max(u, -propeller_.descent_limit * speed);
  const Lanes a = scale * cq[0];
  const Lanes b = scale * cq[1] * linear + k * k * per_resistance_;
  const Lanes c = scale * cq[2] * upwards * upwards -
                  k * (drive_V * per_resistance_ - motor_.no_load_current_A);
  // The larger root of a O^2 + b O + c, in the form that does not cancel for b > 0.
  const Lanes root = sqrt(max(b * b - 4.0 * a * c, 0.0));
  return max(where_positive(b, -2.0 * c / (b + root), (root - b) / (2.0 * a)), kReferenceFloor);
}

ROSFLIGHT_INLINE Multirotor::Disc Multirotor::disc(const Blades& axial, const Lanes& speed,
                                                   const Lanes& along, const Lanes& across_sq,
                                                   double density, const Lanes& factor) const {
  constexpr double kLeastSpeed_rad_s = 1.0;
  constexpr double kLeastSpeed_m_s = 1.0;  // of the tip
  constexpr double kMostTilting = 0.5;     // mu: beyond, the retreating blade stalls
  const Lanes turning = max(speed, kLeastSpeed_rad_s);
  const Lanes climb = max(along, 0.0);
  const Lanes hover_sq = max(axial.thrust_N, 0.0) / (2.0 * density * disc_m2_);
  const Lanes v_axial = axial_inflow(climb, hover_sq);
  Disc out{axial, 0.0};
  Lanes v = v_axial;
  if (momentum_) {
    const Lanes slope = factor * (lift_slope_ / (2.0 * disc_m2_)) * speed;
    v = forward_inflow(climb, across_sq, hover_sq, slope, v_axial);
    out.blades.thrust_N = axial.thrust_N + density * lift_slope_ * factor * speed * (v_axial - v);
    const Lanes power = out.blades.thrust_N * (climb + v) - axial.thrust_N * (climb + v_axial);
    out.blades.torque_Nm = axial.torque_Nm + power / turning;
  }
  if (propeller_.flapping) {
    const Lanes tip = 0.5 * propeller_.diameter_m * speed;
    const Lanes fast = max(max(tip, sqrt(across_sq) / kMostTilting), kLeastSpeed_m_s);
    const Lanes fade = tip / fast;
    const Lanes lambda = (climb + v) / fast;
    out.flapping_s_m = fade * fade * (4.0 * propeller_.flapping->tip_pitch_rad - 2.0 * lambda) /
                       (fast * (1.0 - 0.5 * across_sq / (fast * fast)));
  }
  return out;
}

ROSFLIGHT_INLINE Lanes Multirotor::ground_factor(const Input& in, const Group& group) const {
  const Vector3Lanes& p = group.p_B;
  const Matrix3& R = in.R_WB;
  const double radius = 0.5 * propeller_.diameter_m;
  const Lanes height = in.height_above_ground_m - (R(2, 0) * p.x + R(2, 1) * p.y + R(2, 2) * p.z);
  const Lanes ratio = 0.25 * radius / max(height, 0.5 * radius);
  return where_positive(height - kGroundEffectReach * radius, 1.0, 1.0 / (1.0 - ratio * ratio));
}

/// dO/dt of (4); a rotor at rest stays there while friction exceeds what drives it.
ROSFLIGHT_INLINE Lanes Multirotor::acceleration(const Lanes& speed, const Lanes& current_A,
                                                const Lanes& torque_Nm) const {
  const Lanes motor_Nm = motor_.torque_constant_Nm_A * (current_A - motor_.no_load_current_A);
  const Lanes rate = (motor_Nm - torque_Nm) * per_inertia_;
  return where_positive(speed, rate, max(rate, 0.0));
}

void Multirotor::evaluate(const Input& in, std::span<const double> x, Wrench& wrench,
                          std::span<double> x_dot) const {
  compute(in, x, wrench, x_dot);
}

ROSFLIGHT_WIDE void Multirotor::compute(const Input& in, std::span<const double> x, Wrench& wrench,
                                        std::span<double> x_dot) const {
  groups_ == 1 ? compute_groups<1>(in, x, wrench, x_dot) : compute_groups<0>(in, x, wrench, x_dot);
}

/// @tparam kFixed  groups of rotors if known, else 0: with the usual one all sums stay in registers.
template <std::size_t kFixed>
ROSFLIGHT_INLINE void Multirotor::compute_groups(const Input& in, std::span<const double> x,
                                                 Wrench& wrench, std::span<double> x_dot) const {
  PerRotor speeds;
  load<kFixed>(x, speeds);
  Supply now;
  supply<kFixed>(in.outputs, speeds, x[rotors_], now);
  const double density = in.air.density_kg_m3;
  const double reach_m = kGroundEffectReach * 0.5 * propeller_.diameter_m + extent_m_;
  const bool near_ground =
      aero_.ground_effect == GroundEffect::kCheesemanBennett && in.height_above_ground_m < reach_m;
  const double inertia = propeller_.inertia_kg_m2;

  Vector3Lanes force{0.0, 0.0, 0.0};
  Vector3Lanes torque = force;
  Vector3Lanes momentum = force;  // of the rotors, relative to the body, over -J_r
  Groups turned;
  const Groups& groups = directed(x, turned);
  for (std::size_t g = 0; g < group_count<kFixed>(); ++g) {
    const Group& group = groups[g];
    const Vector3Lanes& e = group.e_B;
    const Vector3Lanes hub = hub_velocity(in, group);
    const Lanes along = inflow(in, group, hub);
    const Lanes u = along * flow_per_speed_;
    Lanes speed = speeds[g];
    Lanes rate = 0.0;
    if (motor_.model != MotorModel::kElectrical) {
      const Lanes target =
          steady_speed(now.duty[g] * now.voltage_V, speed, u, density, group.factor);
      if (motor_.model == MotorModel::kInstant) {
        speed = target;
      } else {
        rate = (target - speed) / motor_.time_constant_s;
      }
    }
    Disc disc_now{blades(speed, u, density, group.factor), 0.0};
    if (momentum_ || propeller_.flapping) {
      const Lanes across_sq = max(dot(hub, hub) - along * along, 0.0);
      disc_now = disc(disc_now.blades, speed, along, across_sq, density, group.factor);
    }
    const Blades& air = disc_now.blades;
    if (motor_.model == MotorModel::kElectrical) {
      rate = acceleration(speed, now.current_A[g], air.torque_Nm);
    }
    if (kFixed == 1 && rotors_ == kLanes) {
      rate.store(x_dot.data());
    } else {
      for (std::size_t i = g * kLanes; i < std::min(rotors_, (g + 1) * kLanes); ++i)
        x_dot[i] = rate[i % kLanes];
    }

    const Lanes thrust = near_ground ? air.thrust_N * ground_factor(in, group) : air.thrust_N;
    Lanes drag = -aero_.rotor_drag_s_m * max(air.thrust_N, 0.0);
    if (propeller_.flapping) drag = drag - disc_now.flapping_s_m * max(air.thrust_N, 0.0);
    const Vector3Lanes h{drag * (hub.x - along * e.x), drag * (hub.y - along * e.y),
                         drag * (hub.z - along * e.z)};
    const Lanes reaction = group.spin * (air.torque_Nm + inertia * rate);
    const Lanes spin = group.spin * speed;
    const Vector3Lanes& p = group.p_B;
    const Vector3Lanes& m = group.p_cross_e_B;
    force = {force.x + thrust * e.x + h.x, force.y + thrust * e.y + h.y,
             force.z + thrust * e.z + h.z};
    torque = {torque.x + thrust * m.x + reaction * e.x, torque.y + thrust * m.y + reaction * e.y,
              torque.z + thrust * m.z + reaction * e.z};
    if (!reference_flow_) {
      torque = {torque.x + (p.y * h.z - p.z * h.y), torque.y + (p.z * h.x - p.x * h.z),
                torque.z + (p.x * h.y - p.y * h.x)};
    }
    if (propeller_.flapping) {
      const Lanes k = -propeller_.flapping->hub_stiffness_Nm_rad * disc_now.flapping_s_m;
      torque = {torque.x + k * (e.y * hub.z - e.z * hub.y),
                torque.y + k * (e.z * hub.x - e.x * hub.z),
                torque.z + k * (e.x * hub.y - e.y * hub.x)};
    }
    momentum = {momentum.x + spin * e.x, momentum.y + spin * e.y, momentum.z + spin * e.z};
  }

  const Vector3& v = in.v_air_B;
  const Vector3 drag_B = (0.5 * density * v.norm()) * aero_.drag_area_m2.cwiseProduct(v);
  wrench.force_B = Vector3(sum(force.x), sum(force.y), sum(force.z)) - drag_B;
  if (aero_.ground_effect == GroundEffect::kPolynomial) {
    double lift = 0.0;
    for (const double c : aero_.ground_effect_polynomial)
      lift = lift * in.height_above_ground_m + c;
    wrench.force_B.z() -= std::max(lift, 0.0);
  }
  const Vector3 spinning = inertia * Vector3(sum(momentum.x), sum(momentum.y), sum(momentum.z));
  wrench.torque_B =
      Vector3(sum(torque.x), sum(torque.y), sum(torque.z)) + in.body.w_B.cross(spinning);
  if (off_centre_) wrench.torque_B -= aero_.centre_B.cross(drag_B);
  x_dot[rotors_] = battery_.constant() ? 0.0 : -now.current_sum_A;
  for (std::size_t i = 0; i < tilts_.size(); ++i) {
    const TiltParameters& servo = tilts_[i].servo;
    const double output = static_cast<double>(in.outputs[servo.output]);
    const double command = servo.travel_rad * (2.0 * std::clamp(output, 0.0, 1.0) - 1.0);
    const double rate = (command - x[rotors_ + 1 + i]) / servo.time_constant_s;
    x_dot[rotors_ + 1 + i] =
        std::isnan(rate) || tilts_[i].stuck
            ? 0.0
            : std::clamp(rate, -servo.rate_limit_rad_s, servo.rate_limit_rad_s);
  }
}

void Multirotor::limit_state(std::span<double> x) const {
  for (std::size_t i = 0; i < rotors_; ++i) x[i] = std::max(x[i], 0.0);
  x[rotors_] = std::clamp(x[rotors_], 0.0, charge_limit_ * battery_.capacity_As());
}

void Multirotor::report(const Input& in, std::span<const double> x, Truth& truth) const {
  fill_truth(in, x, truth);
}

ROSFLIGHT_WIDE void Multirotor::fill_truth(const Input& in, std::span<const double> x,
                                           Truth& truth) const {
  PerRotor speeds;
  load<0>(x, speeds);
  Supply now;
  supply<0>(in.outputs, speeds, x[rotors_], now);
  if (motor_.model == MotorModel::kInstant) {
    Groups turned;
    const Groups& groups = directed(x, turned);
    for (std::size_t g = 0; g < groups_; ++g) {
      const Group& group = groups[g];
      const Lanes u = inflow(in, group, hub_velocity(in, group)) * flow_per_speed_;
      speeds[g] = steady_speed(now.duty[g] * now.voltage_V, speeds[g], u, in.air.density_kg_m3,
                               group.factor);
    }
    supply<0>(in.outputs, speeds, x[rotors_], now);
  }
  truth.rotor_count = rotors_;
  for (std::size_t i = 0; i < rotors_; ++i) {
    truth.rotor_speed_rad_s[i] = speeds[i / kLanes][i % kLanes];
  }
  truth.battery_voltage_V = now.voltage_V;
  truth.battery_current_A = now.current_sum_A;
}

}  // namespace rosflight::sim
