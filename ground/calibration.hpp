// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "ground/ground_link.hpp"
#include "ground/sensor_calibration.hpp"

/// Calibrations with a figure of quality. Nothing is changed when a figure is beyond its limit before the
/// calibration; when one is beyond it afterwards, the former values are put back.
namespace rosflight::ground {

struct CalibrationOptions {
  Time wait{std::chrono::seconds{60}};  ///< For each step that a person does.
  bool write{false};                    ///< Store the parameters when it was good.
  bool props_off{false};  ///< A person confirms that no propeller is mounted; for `esc`.
};

// Each prints what it does and finds, and returns the exit code: 0, or 1 if it was refused or is not
// good enough; the last line names the figure and its limit. They expect a connected link.
// @throws NoAnswer @throws Stopped

/// Gyro: at rest.
int calibrate_gyro(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Accelerometer: at rest and level.
int calibrate_accel(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Barometer: at rest, without wind.
int calibrate_baro(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Pitot tube: covered against wind.
int calibrate_airspeed(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Magnetometer: a person turns the vehicle (companion/mag_calibration.hpp).
int calibrate_mag(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Receiver: ranges and centres of the sticks, then the trim of the transmitter as torques.
int calibrate_rc(GroundLink& link, const CalibrationOptions& options, std::ostream& out);
/// Speed controllers: the mixer for their calibration, both ends of the throttle stick on all motors, and the
/// former mixer again.
int calibrate_esc(GroundLink& link, const CalibrationOptions& options, std::ostream& out);

// Shared by them.

/// One line on `out`, at once.
void say(std::ostream& out, const std::string& line);
/// Present values. @throws NoAnswer  the vehicle does not have one.
companion::ParameterSet read_values(GroundLink& link, const std::vector<std::string>& names);
/// Stores the parameters if wanted; prints otherwise that they are not. @returns the exit code.
int store_calibration(GroundLink& link, bool write, std::ostream& out);

}  // namespace rosflight::ground
