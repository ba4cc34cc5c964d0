// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/fixedwing/flight_manager.hpp"
#include "autonomy/fixedwing/mission.hpp"
#include "base/atmosphere.hpp"
#include "base/constants.hpp"
#include "config/strict_yaml.hpp"
#include "config/table_fwd.hpp"

namespace rosflight::autonomy::fixedwing {

/// Values from other sections of the vehicle file; passed in, so that no number is written twice.
struct VehicleFacts {
  double mass_kg{};
  double gravity_m_s2{base::kStandardGravity_m_s2};
  double wing_area_m2{};
  double density_kg_m3{base::kSeaLevelDensity_kg_m3};  ///< At the start.
  double lift_zero{};
  double lift_alpha_1_rad{};
  double pitch_zero{};
  double pitch_alpha_1_rad{};
  double pitch_elevator_1_rad{};  ///< < 0: a positive deflection pitches down.
  BatteryConfig battery{};        ///< Its cells, capacity and resistance.
};

struct AutonomyConfig {
  FlightConfig flight{};
  MissionLimits mission{};
  double elevator_travel_rad{0.0};  ///< Deflection at a pitch command of 1; 0: not known.
};

/// The parameters of the section `autonomy`: config/table.hpp.
config::Table<AutonomyConfig> parameters();

/// Reads the section `autonomy` of a fixed wing's vehicle file; docs/autonomy-keys.md lists the
/// keys. Every key may be absent: the defaults of the structs hold.
/// Throws config::Error for a key that is unknown, of the wrong type or out of range, and for turns
/// that the bank limit does not allow. Finishes the section.
AutonomyConfig read_autonomy(const config::Section& autonomy, const VehicleFacts& vehicle);

}  // namespace rosflight::autonomy::fixedwing
