// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/flight_manager.hpp"
#include "autonomy/multirotor/mission.hpp"
#include "config/strict_yaml.hpp"
#include "config/table_fwd.hpp"

namespace rosflight::autonomy::multirotor {

/// Values from other sections of the vehicle file; passed in, so that no number is written twice.
struct VehicleFacts {
  double mass_kg{};
  double gravity_m_s2{9.81};
  RotorData rotors{};
  ThrottlePath throttle{};
  BatteryConfig battery{};         ///< Its cells, capacity and resistance.
  RotorWatchConfig rotor_watch{};  ///< Its rotors and inertia; no rotors: none is watched.
};

struct AutonomyConfig {
  FlightConfig flight{};
  MissionLimits mission{};
  double min_thrust_weights{0.2};  ///< Thrust limits in weights of the vehicle; at most 95 % of
  double max_thrust_weights{2.0};  ///< full throttle.
  std::optional<ThrustModel::Curve> thrust_curve;  ///< Measured, else from the rotors.
};

/// The parameters of the section `autonomy`: config/table.hpp.
config::Table<AutonomyConfig> parameters();

/// Reads the section `autonomy` of a vehicle file; docs/autonomy-keys.md lists the keys. Every key
/// may be absent: the defaults of the structs hold, with thrust limits in weights of this vehicle.
/// Throws config::Error for a key that is unknown, of the wrong type or out of range, and for a
/// vehicle that cannot fly. Finishes the section.
AutonomyConfig read_autonomy(const config::Section& autonomy, const VehicleFacts& vehicle);

}  // namespace rosflight::autonomy::multirotor
