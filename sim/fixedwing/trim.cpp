// SPDX-License-Identifier: BSD-3-Clause
#include "sim/fixedwing/trim.hpp"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/constants.hpp"
#include "sim/fixedwing/motion.hpp"

namespace rosflight::sim {
namespace {

using Vector = Eigen::VectorXd;

/// The unknowns, scaled so that each is of the order of 1.
enum Unknown : Eigen::Index { kAlpha, kRoll, kPitch, kThrottle, kAileron, kElevator, kRudder, kOf };
constexpr double kSpeedScale_rad_s = 500.0;  // of the rotor speeds that follow

constexpr int kMaxSteps = 60;
constexpr int kMaxHalvings = 12;
constexpr double kGoodEnough = 2e-5;  // outputs are floats: 6e-8 of full thrust and deflection
constexpr double kNearlyFull = 0.9999;

double length(const Vector& residual) {
  return residual.cwiseAbs().maxCoeff();
}

/// Everything a point of the search stands for, and what is left of the equations there.
class Search {
 public:
  Search(const TrimVehicle& vehicle, const FlightCondition& condition)
      : vehicle_{vehicle}, parameters_{vehicle.forces.parameters()} {
    trim_.condition = condition;
    const Atmosphere atmosphere(vehicle.environment.atmosphere);
    const AirProperties air =
        atmosphere.at(vehicle.environment.origin.altitude_m + condition.height_m);
    trim_.air = {air.density_kg_m3, air.pressure_Pa, air.temperature_K, Vector3::Zero()};
    trim_.module_state.resize(vehicle.forces.state_size());
    x_dot_.resize(vehicle.forces.state_size());
    vehicle.forces.initial_state(trim_.module_state);
    const bool instant = parameters_.propulsion.motor.model == MotorModel::kInstant;
    speeds_ = instant ? 0 : static_cast<Eigen::Index>(parameters_.propulsion.rotors.size());
    Eigen::Matrix3Xd effect(3, parameters_.surfaces.size());
    for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i)
      effect.col(static_cast<Eigen::Index>(i)) = parameters_.surfaces[i].effect;
    // Least deflections that give what is asked for.
    share_ = effect.completeOrthogonalDecomposition().pseudoInverse();
  }

  /// @param load  advance ratio of the propellers as a share of that without thrust.
  Vector first_guess(double load) const {
    const AirframeParameters& wing = parameters_.airframe;
    const FlightCondition& c = trim_.condition;
    const double weight_N = vehicle_.body.mass_kg * vehicle_.environment.gravity_m_s2;
    const double lift =
        weight_N / (0.5 * trim_.air.density_kg_m3 * c.airspeed_m_s * c.airspeed_m_s * wing.area_m2);
    const double most = 0.8 * wing.stall_angle_rad;
    Vector z = Vector::Zero(kOf + speeds_);
    z[kAlpha] = std::clamp((lift - wing.lift.zero) / wing.lift.alpha, -most, most);
    if (c.turn_radius_m != 0.0) {
      z[kRoll] = std::atan(c.airspeed_m_s * c.airspeed_m_s /
                           (vehicle_.environment.gravity_m_s2 * c.turn_radius_m));
    }
    z[kPitch] = z[kAlpha] + c.climb_rad;
    const PropellerParameters& propeller = parameters_.propulsion.propeller;
    const MotorParameters& motor = parameters_.propulsion.motor;
    const auto& ct = propeller.thrust;
    // The positive root of C_T; a propeller without one is taken as lightly loaded.
    const double root = std::sqrt(std::max(0.0, ct[1] * ct[1] - 4.0 * ct[0] * ct[2]));
    const double free = ct[2] < 0.0 ? -(ct[1] + root) / (2.0 * ct[2]) : 1.0;
    const double speed_rad_s =
        2.0 * base::kPi * c.airspeed_m_s / (load * free * propeller.diameter_m);
    const Battery battery(parameters_.propulsion.battery);
    const double supply_V = battery.open_circuit_V(battery.initial_charge_As());
    constexpr double kLoss_V = 1.0;  // of the current, so that there is one
    z[kThrottle] = std::clamp(
        (motor.torque_constant_Nm_A * speed_rad_s + kLoss_V) / std::max(supply_V, kLoss_V), 0.1,
        0.95);
    z.tail(speeds_).setConstant(speed_rad_s / kSpeedScale_rad_s);
    return z;
  }

  /// Keeps what has limits inside them.
  void limit(Vector& z) const {
    z[kThrottle] = std::clamp(z[kThrottle], 0.0, 1.0);
    z.tail(speeds_) = z.tail(speeds_).cwiseMax(0.02);
    z[kAlpha] = std::clamp(z[kAlpha], -1.0, 1.0);
    z[kPitch] = std::clamp(z[kPitch], -1.5, 1.5);
    z[kRoll] = std::clamp(z[kRoll], -1.5, 1.5);
  }

  Vector residual(const Vector& z) {
    const FlightCondition& c = trim_.condition;
    const double speed = c.airspeed_m_s;
    const double turn_rad_s =
        c.turn_radius_m == 0.0 ? 0.0 : speed * std::cos(c.climb_rad) / c.turn_radius_m;
    trim_.alpha_rad = z[kAlpha];
    trim_.roll_rad = z[kRoll];
    trim_.pitch_rad = z[kPitch];
    trim_.throttle = z[kThrottle];
    trim_.deflection = {z[kAileron], z[kElevator], z[kRudder]};
    set_actuators(z);
    trim_.body.p_W = {0.0, 0.0, -c.height_m};
    trim_.body.q_WB = detail::attitude(z[kRoll], z[kPitch]);
    trim_.body.v_B = speed * Vector3(std::cos(z[kAlpha]), 0.0, std::sin(z[kAlpha]));
    trim_.body.w_B = trim_.body.q_WB.conjugate() * Vector3(0.0, 0.0, turn_rad_s);
    const detail::Acceleration a = detail::accelerate(
        vehicle_, trim_.air, {trim_.body.v_B, trim_.body.w_B, z[kRoll], z[kPitch]}, trim_.outputs,
        trim_.module_state, x_dot_);
    trim_.wrench = a.wrench;
    trim_.acceleration_B = a.v_dot_B;
    trim_.angular_acceleration_B = a.w_dot_B;
    Vector left(kOf + speeds_);
    left.segment<3>(0) = a.v_dot_B;
    left.segment<3>(3) = a.w_dot_B;
    left[6] = (trim_.body.q_WB * trim_.body.v_B).z() / speed + std::sin(c.climb_rad);
    for (Eigen::Index i = 0; i < speeds_; ++i)
      left[kOf + i] = x_dot_[static_cast<std::size_t>(i)] / kSpeedScale_rad_s;
    return left;
  }

  Eigen::MatrixXd jacobian(const Vector& z) {
    constexpr double kStep = 2e-4;  // large enough for outputs that are floats
    Eigen::MatrixXd slope(z.size(), z.size());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      // Clamped at its end, a throttle is varied inwards.
      Vector high = z;
      Vector low = z;
      high[i] += kStep;
      low[i] -= kStep;
      limit(high);
      limit(low);
      slope.col(i) = (residual(high) - residual(low)) / (high[i] - low[i]);
    }
    return slope;
  }

  /// After residual() at the solution.
  Trim finish() {
    Wrench airframe;
    vehicle_.forces.airframe().add_wrench(trim_.body.v_B, trim_.body.w_B, trim_.air.density_kg_m3,
                                          trim_.deflection, airframe);
    trim_.thrust_N = (trim_.wrench.force_B - airframe.force_B).x();
    const double c = std::cos(trim_.alpha_rad);
    const double s = std::sin(trim_.alpha_rad);
    const Vector3& f = airframe.force_B;
    trim_.lift_to_drag = (f.x() * s - f.z() * c) / -(f.x() * c + f.z() * s);
    return trim_;
  }

  std::string reason() const {
    const FlightCondition& c = trim_.condition;
    const AirframeParameters& wing = parameters_.airframe;
    double most = 0.0;
    constexpr int kAngles = 120;  // to 0.6 rad
    for (int i = 0; i < kAngles; ++i)
      most = std::max(most, vehicle_.forces.airframe().lift_coefficient(0.005 * i));
    const double pressure_Pa = 0.5 * trim_.air.density_kg_m3 * c.airspeed_m_s * c.airspeed_m_s;
    const double weight_N = vehicle_.body.mass_kg * vehicle_.environment.gravity_m_s2;
    if (pressure_Pa * wing.area_m2 * most < weight_N * std::cos(c.climb_rad))
      return "more lift than the wing has";
    if (trim_.throttle >= kNearlyFull) return "more than full throttle";
    if (trim_.throttle <= 1.0 - kNearlyFull) return "less than no throttle";
    for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i) {
      const float output = trim_.outputs[parameters_.surfaces[i].output];
      if (output <= 0.0F || output >= 1.0F) return "more than full deflection";
    }
    return "more thrust, lift or deflection than it has";
  }

  bool within_travel() const {
    const Vector3 asked(trim_.deflection.aileron_rad, trim_.deflection.elevator_rad,
                        trim_.deflection.rudder_rad);
    const Vector angles = share_ * asked;
    for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i) {
      if (std::abs(angles[static_cast<Eigen::Index>(i)]) > parameters_.surfaces[i].travel_rad)
        return false;
    }
    return true;
  }

 private:
  void set_actuators(const Vector& z) {
    for (const RotorParameters& rotor : parameters_.propulsion.rotors)
      trim_.outputs[rotor.output] = static_cast<float>(z[kThrottle]);
    for (Eigen::Index i = 0; i < speeds_; ++i)
      trim_.module_state[static_cast<std::size_t>(i)] = kSpeedScale_rad_s * z[kOf + i];
    const Vector angles = share_ * z.segment<3>(kAileron);
    const std::size_t first = trim_.module_state.size() - parameters_.surfaces.size();
    for (std::size_t i = 0; i < parameters_.surfaces.size(); ++i) {
      const SurfaceParameters& surface = parameters_.surfaces[i];
      const double angle = angles[static_cast<Eigen::Index>(i)];
      trim_.module_state[first + i] = angle;
      trim_.outputs[surface.output] =
          static_cast<float>(std::clamp(0.5 + 0.5 * angle / surface.travel_rad, 0.0, 1.0));
    }
  }

  TrimVehicle vehicle_;
  const FixedWingParameters& parameters_;
  Trim trim_;
  Eigen::Index speeds_{};
  Eigen::MatrixXd share_;  ///< Surfaces' angles for aileron, elevator, rudder.
  std::vector<double> x_dot_;
};

}  // namespace

namespace detail {

Quaternion attitude(double roll_rad, double pitch_rad) {
  return Eigen::AngleAxisd(pitch_rad, Vector3::UnitY()) *
         Eigen::AngleAxisd(roll_rad, Vector3::UnitX());
}

Acceleration accelerate(const TrimVehicle& vehicle, const Air& air, const Motion& motion,
                        const hal::OutputValues& outputs, std::span<const double> x,
                        std::span<double> x_dot) {
  constexpr double kHigh_m = 1e6;  // no ground
  const BodyState body{Vector3::Zero(), attitude(motion.roll_rad, motion.pitch_rad), motion.v_B,
                       motion.w_B};
  const Matrix3 R_WB = body.q_WB.toRotationMatrix();
  Acceleration a;
  vehicle.forces.evaluate({body, R_WB, body.v_B, air, outputs, kHigh_m}, x, a.wrench, x_dot);
  const Matrix3& J = vehicle.body.inertia_kg_m2;
  a.v_dot_B = a.wrench.force_B / vehicle.body.mass_kg +
              vehicle.environment.gravity_m_s2 * R_WB.row(2).transpose() -
              motion.w_B.cross(motion.v_B);
  a.w_dot_B = J.inverse() * (a.wrench.torque_B - motion.w_B.cross(J * motion.w_B));
  return a;
}

}  // namespace detail

namespace {

/// From a guess to the nearest solution, or to where Newton's method gives up; `search` is there
/// afterwards. @returns whether it is a solution.
bool solve(Search& search, Vector z) {
  Vector left = search.residual(z);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Vector delta = search.jacobian(z).fullPivLu().solve(-left);
    double share = 1.0;
    bool better = false;
    for (int halving = 0; halving < kMaxHalvings && !better; ++halving, share *= 0.5) {
      Vector next = z + share * delta;
      search.limit(next);
      const Vector next_left = search.residual(next);
      if (next_left.norm() < left.norm()) {
        z = next;
        left = next_left;
        better = true;
      }
    }
    if (!better) break;
  }
  search.residual(z);
  return length(left) < kGoodEnough;
}

}  // namespace

Trim find_trim(const TrimVehicle& vehicle, const FlightCondition& condition) {
  Search search(vehicle, condition);
  constexpr double kLoads[] = {0.85, 0.95, 0.7, 0.5};
  for (const double load : kLoads) {
    if (!solve(search, search.first_guess(load))) continue;
    if (search.within_travel()) return search.finish();
    break;
  }
  throw std::runtime_error("needs " + search.reason());
}

}  // namespace rosflight::sim
