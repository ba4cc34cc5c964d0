// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "sim/dynamics/rigid_body.hpp"
#include "sim/fixedwing/trim.hpp"
#include "sim/registry.hpp"

/// What the tests of fixed wings share.
namespace rosflight::sim::test {

inline std::string vehicle_file(const std::string& name) {
  return "vehicles/" + name + ".yaml";  // tests run in the root of the project
}

/// One of the vehicles of ROSflight 2.x, with its numbers.
struct ReferenceAircraft {
  std::string name;
  double density_kg_m3;
  double voltage_V;
};

inline const std::vector<ReferenceAircraft> kReferenceAircraft{{"anaconda", 1.2682, 24.0},
                                                               {"openvsp_anaconda", 1.204, 24.0},
                                                               {"xflr5_anaconda", 1.225, 24.0},
                                                               {"aerosonde", 1.2682, 44.4}};

/// The options of ROSflight 2.x's simulator.
inline std::vector<std::string> reference_options(const ReferenceAircraft& aircraft) {
  std::vector<std::string> options{
      "rotors.motor.model=instant",
      "rotors.flow=airspeed",
      "rotors.motor.active_braking=true",
      "battery.model=constant",
      "battery.constant_voltage_V=" + std::to_string(aircraft.voltage_V),
      "aero.model=reference",
      "ground.model=frictionless_plane",
      "body.integration=frozen_forces",
      "environment.gravity_m_s2=9.81",
      "environment.atmosphere.model=constant",
      "environment.atmosphere.density_kg_m3=" + std::to_string(aircraft.density_kg_m3)};
  if (aircraft.name == "aerosonde") options.emplace_back("aero.drag.parasitic=0");
  return options;
}

/// A vehicle of vehicles/, ready to fly.
struct Hangar {
  explicit Hangar(const std::string& name, const std::vector<std::string>& options = {},
                  std::uint64_t seed = 1)
      : vehicle{Vehicle::from_file(vehicle_file(name), options)},
        random{seed},
        forces{read_fixed_wing(vehicle.root())},
        dynamics{vehicle.body(), vehicle.ground(), vehicle.environment(), forces, random} {}
  explicit Hangar(const ReferenceAircraft& aircraft)
      : Hangar(aircraft.name, reference_options(aircraft)) {}

  TrimVehicle trimmed() const { return {forces, vehicle.body(), vehicle.environment()}; }
  Trim trim(const FlightCondition& condition) const { return find_trim(trimmed(), condition); }
  /// Level and straight.
  Trim trim(double airspeed_m_s) const { return trim(FlightCondition{airspeed_m_s, 0, 0, 0}); }

  Vehicle vehicle;
  RandomSource random;
  FixedWing forces;
  RigidBody dynamics;
};

}  // namespace rosflight::sim::test
