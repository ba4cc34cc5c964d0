// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/multirotor/thrust_model.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace rosflight::autonomy::multirotor {
namespace {

void require(bool good, const char* what, double found) {
  if (!good) throw std::invalid_argument(std::string(what) + ", found " + std::to_string(found));
}

}  // namespace

ThrustModel::ThrustModel(const Curve& curve, const ThrottlePath& path)
    : curve_(curve), path_(path), square_(1.0 - curve.constant - curve.root) {
  require(curve.max_thrust_N > 0.0, "largest thrust must be > 0 N", curve.max_thrust_N);
  require(curve.constant >= 0.0 && curve.constant < 1.0, "constant share must be in [0, 1)",
          curve.constant);
  require(curve.root >= 0.0 && curve.root + curve.constant < 1.0 + 1e-9,
          "root share must be in [0, 1 - constant]", curve.root);
  require(path.rc_max_thr > 0.0 && path.rc_max_thr <= 1.0, "RC_MAX_THR must be in (0, 1]",
          path.rc_max_thr);
  require(path.firmware_max_thrust_N >= 0.0, "thrust known to the firmware must be >= 0 N",
          path.firmware_max_thrust_N);
  square_ = std::max(square_, 0.0);
}

ThrustModel::Curve ThrustModel::curve_of(const RotorData& rotors) {
  const double d2 = rotors.diameter_m * rotors.diameter_m;
  const double d4 = d2 * d2;
  const double per_square = rotors.air_density_kg_m3 * d4 / (4.0 * kPi * kPi);
  const double k_thrust = rotors.thrust_coefficient * per_square;
  const double k_torque = rotors.torque_coefficient * per_square * rotors.diameter_m;
  const double resistive =
      rotors.resistance_ohm / rotors.motor_constant * k_torque;  // V per (rad/s)^2
  const double idle_V = rotors.resistance_ohm * rotors.no_load_current_A;
  const double supply_V = rotors.supply_voltage_V;
  const double k = rotors.motor_constant;
  // resistive W^2 + k W = supply - idle, solved without cancellation
  const double available_V = supply_V - idle_V;
  const double w_max = 2.0 * available_V / (k + std::sqrt(k * k + 4.0 * resistive * available_V));
  return {rotors.count * k_thrust * w_max * w_max, idle_V / supply_V, k * w_max / supply_V,
          supply_V};
}

double ThrustModel::throttle(double thrust_N, double voltage_V, double density_ratio) const {
  if (path_.firmware_max_thrust_N > 0.0) {
    return std::clamp(thrust_N / (path_.rc_max_thr * path_.firmware_max_thrust_N), 0.0, 1.0);
  }
  if (!(thrust_N > 0.0)) return 0.0;
  const double x = thrust_N / curve_.max_thrust_N;
  double output = curve_.constant + curve_.root * std::sqrt(x / density_ratio) + square_ * x;
  if (voltage_V > 0.0) output *= curve_.nominal_voltage_V / voltage_V;
  return std::clamp(output / path_.rc_max_thr, 0.0, 1.0);
}

double ThrustModel::thrust_N(double throttle, double voltage_V, double density_ratio) const {
  const double given = std::clamp(throttle, 0.0, 1.0) * path_.rc_max_thr;
  if (path_.firmware_max_thrust_N > 0.0) return given * path_.firmware_max_thrust_N;
  const double scale = voltage_V > 0.0 ? voltage_V / curve_.nominal_voltage_V : 1.0;
  const double left = given * scale - curve_.constant;
  if (left <= 0.0) return 0.0;
  // square y^2 + root y - left = 0 for y = sqrt(x), solved without cancellation
  const double root = curve_.root / std::sqrt(density_ratio);
  const double y = 2.0 * left / (root + std::sqrt(root * root + 4.0 * square_ * left));
  return curve_.max_thrust_N * y * y;
}

}  // namespace rosflight::autonomy::multirotor
