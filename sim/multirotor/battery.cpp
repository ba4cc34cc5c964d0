// SPDX-License-Identifier: BSD-3-Clause
#include "sim/multirotor/battery.hpp"

namespace rosflight::sim {

Battery::Battery(const BatteryParameters& p)
    : constant_{p.constant},
      constant_voltage_V_{p.constant_voltage_V},
      capacity_As_{p.constant ? 1.0 : p.capacity_As},
      initial_charge_As_{p.constant ? 1.0 : p.initial_charge * p.capacity_As},
      resistance_ohm_{p.constant ? 0.0 : p.resistance_ohm},
      avionics_current_A_{p.avionics_current_A},
      last_interval_{static_cast<double>(p.open_circuit_cell_V.size()) - 1.0},
      intervals_per_As_{p.constant ? 0.0 : last_interval_ / p.capacity_As} {
  curve_V_.reserve(p.open_circuit_cell_V.size());
  for (const double cell_V : p.open_circuit_cell_V) curve_V_.push_back(p.cells * cell_V);
}

}  // namespace rosflight::sim
