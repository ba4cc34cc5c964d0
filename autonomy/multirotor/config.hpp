// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/multirotor/flight_manager.hpp"
#include "autonomy/multirotor/mission.hpp"
#include "config/strict_yaml.hpp"

namespace rosflight::autonomy {

/// What other sections of the vehicle file say; given, so that no number stands in two places.
struct VehicleFacts {
  double mass_kg{};
  double gravity_m_s2{9.81};
  RotorData rotors{};
  ThrottlePath throttle{};
};

struct AutonomyConfig {
  FlightConfig flight{};
  MissionLimits mission{};
};

/// Reads the section `autonomy` of a vehicle file; docs/autonomy-keys.md lists the keys. Every key
/// may be absent: the defaults of the structs hold, with thrust limits in weights of this vehicle.
/// Throws config::Error for a key that is unknown, of the wrong type or out of range, and for a
/// vehicle that cannot fly. Finishes the section.
AutonomyConfig read_autonomy(const config::Section& autonomy, const VehicleFacts& vehicle);

}  // namespace rosflight::autonomy
