// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <vector>

namespace rosflight::sim {

struct BatteryParameters {
  bool constant{false};                     ///< Voltage source without resistance and end.
  double constant_voltage_V{};              ///< Only with `constant`.
  double cells{};                           ///< In series.
  double capacity_As{};                     ///< Charge from full to empty.
  double initial_charge{1.0};               ///< Fraction of the capacity at the start, 0..1.
  double resistance_ohm{};                  ///< Resistance of the pack with its leads.
  double avionics_current_A{};              ///< Drawn besides the motors.
  std::vector<double> open_circuit_cell_V;  ///< At equal steps of charge from 0 to 1, at least two.
};

/// Battery with a voltage that follows its charge:  V = U0(charge) - R I,  d charge/dt = -I.
///
/// U0 is piecewise linear in the charge. An empty battery has no voltage. The charge [A s] is a state
/// of the owner.
class Battery {
 public:
  /// @param parameters  as read_propulsion() checks them.
  explicit Battery(const BatteryParameters& parameters);

  bool constant() const { return constant_; }
  double initial_charge_As() const { return initial_charge_As_; }
  double capacity_As() const { return capacity_As_; }
  double resistance_ohm() const { return resistance_ohm_; }
  double avionics_current_A() const { return avionics_current_A_; }

  /// Voltage without load [V].
  double open_circuit_V(double charge_As) const {
    if (constant_) return constant_voltage_V_;
    if (!(charge_As > 0.0)) return 0.0;
    const double x = charge_As * intervals_per_As_;
    if (!(x < last_interval_)) return curve_V_.back();
    const auto i = static_cast<std::size_t>(x);
    return curve_V_[i] + (x - static_cast<double>(i)) * (curve_V_[i + 1] - curve_V_[i]);
  }

 private:
  bool constant_;
  double constant_voltage_V_;
  double capacity_As_;
  double initial_charge_As_;
  double resistance_ohm_;
  double avionics_current_A_;
  double last_interval_;  ///< Number of intervals of the curve.
  double intervals_per_As_;
  std::vector<double> curve_V_;  ///< Open-circuit voltage of the pack over charge.
};

}  // namespace rosflight::sim
