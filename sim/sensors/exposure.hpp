// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight::sim::sensors {

/// What the parts of a board are exposed to, where the parts themselves are modelled, with their filters,
/// converters and clocks: the same world and the same errors, available at once and finely in time.
///
/// The IMU has a sample each `imu_period`, the others one each `period`; satellites keep their rate, at the whole
/// multiples of its period, at which a receiver measures. None has a delay or a rounding of its own. White noise of the IMU keeps the density that it has at its rate in the vehicle file, so a filter
/// behind it makes the less of it the narrower it is; each sample of the others keeps its noise. Vibration is lines
/// at the frequencies of rotors and blades (Imu, equation 2) in place of white noise.
SensorsConfig exposure(SensorsConfig config, Time imu_period, Time period);

}  // namespace rosflight::sim::sensors
