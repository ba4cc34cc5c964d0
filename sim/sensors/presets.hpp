// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/standard_sensors.hpp"

/// Complete sets of sensor parameters. A vehicle file names one and overrides single values; README.md
/// compares them.
namespace rosflight::sim::sensors {

/// Parts that ROSflight boards carry today, after their data sheets.
SensorsConfig current_hardware();
/// The errors of the ROSflight 2.x simulator (state of August 2026), as its launch files put them
/// in force. Differences that remain: Gauss-Markov errors start stationary instead of at 0, "armed"
/// is read off the rotors, positions are on the WGS-84 ellipsoid instead of a sphere.
SensorsConfig reference();
/// Same rates as current_hardware(), no errors and no delays at all.
SensorsConfig ideal();

}  // namespace rosflight::sim::sensors
