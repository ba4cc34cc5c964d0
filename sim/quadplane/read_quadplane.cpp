// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string>

#include "config/table.hpp"
#include "sim/parameter_tables.hpp"
#include "sim/quadplane/quadplane.hpp"

namespace rosflight::sim {

bool lifts(const RotorParameters& rotor) {
  constexpr double kUpward = 0.5;  // cosine of its angle from the vertical
  return -rotor.e_B.z() > kUpward;
}

FixedWingParameters read_quadplane(const config::Section& vehicle) {
  FixedWingParameters p = read_fixed_wing(vehicle);
  const config::Section aero = vehicle.section("rotor_aero");
  aero_parameters().read(aero, p.propulsion.aero);
  aero.finish();
  const auto& rotors = p.propulsion.rotors;
  const auto lifting = std::ranges::count_if(rotors, lifts);
  constexpr std::ptrdiff_t kNeeded = 4;
  if (lifting < kNeeded || lifting == std::ranges::ssize(rotors)) {
    throw vehicle.section("rotors").error(
        "layout", std::to_string(lifting) + " lifting rotors of " + std::to_string(rotors.size()),
        "four or more that push up, and one that pushes forward");
  }
  return p;
}

}  // namespace rosflight::sim
