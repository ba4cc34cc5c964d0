// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "config/table_fwd.hpp"
#include "sim/dynamics/ground_contact.hpp"
#include "sim/dynamics/rigid_body.hpp"
#include "sim/environment/environment.hpp"
#include "sim/fixedwing/fixedwing.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"

/// Parameters of the sections of a vehicle file (config/table.hpp). Those of the sensors:
/// sim/sensors/read_config.hpp.
namespace rosflight::sim {

/// Section `body`.
config::Table<BodyParameters> body_parameters();
/// Section `rotors`.
config::Table<MultirotorParameters> rotor_parameters();
config::Table<BatteryParameters> battery_parameters();
/// Section `aero` of a multirotor.
config::Table<AeroParameters> aero_parameters();
/// Section `aero` of a fixed wing.
config::Table<AirframeParameters> airframe_parameters();
config::Table<FixedWingParameters> surface_parameters();
config::Table<GroundParameters> ground_parameters();
/// All but `start_utc`.
config::Table<EnvironmentParameters> environment_parameters();

}  // namespace rosflight::sim
