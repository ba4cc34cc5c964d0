// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "config/table.hpp"
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight::sim::sensors {

/// Reads the section `sensors` of a vehicle file for the module `standard`: `preset` (current,
/// reference, ideal; default current) and, below the name of each sensor, what differs from it.
/// Keys, units, limits and the defaults of `current`: docs/vehicle-keys.md. Finishes the section. @throws config::Error  unknown key,
/// wrong type or unit, value out of range.
SensorsConfig read_sensors(const config::Section& section);

/// Clock and delay: enabled, rate_Hz (kept as a period of whole microseconds), phase_us, delay_us.
config::Table<Timing> timing_table();
/// Errors of three axes, in the unit of the section's name.
config::Table<VectorErrorParameters> vector_error_table();

/// What it reads after the preset, one row per key.
config::Table<SensorsConfig> sensor_tables();

}  // namespace rosflight::sim::sensors
