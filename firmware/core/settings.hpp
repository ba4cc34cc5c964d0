// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "firmware/core/command.hpp"
#include "firmware/core/controller.hpp"
#include "firmware/core/estimator.hpp"
#include "firmware/core/mixer.hpp"
#include "firmware/core/parameters.hpp"
#include "firmware/core/rc.hpp"
#include "firmware/core/sensors.hpp"

/// Converts the parameter table to the settings struct of each module. Only here a parameter meets
/// its use.
namespace rosflight::core {

/// Settings of Sensors.
Sensors::Config sensor_settings(const Parameters& p);
/// Settings of Estimator.
Estimator::Config estimator_settings(const Parameters& p);
/// Settings of Rc.
Rc::Config rc_settings(const Parameters& p);
/// @param override_whole  the mixers differ (CommandManager::Config).
CommandManager::Config command_settings(const Parameters& p, const Rc& rc, bool override_whole);
/// The motor model of MOTOR_... and PROP_...
MotorModel motor_settings(const Parameters& p);
/// @param max_thrust_N  1 unless USE_MOTOR_PARAM.
Controller::Config controller_settings(const Parameters& p, float max_thrust_N);
/// Settings of Mixer. @param max_thrust_N  as above.
Mixer::Config mixer_settings(const Parameters& p, float max_thrust_N);

/// PRIMARY_MIXER is the one that calibrates speed controllers: the stick drives all motors from 0
/// to 1, without idle, RC_MAX_THR or motor parameters.
bool calibrates_escs(const Parameters& p);
/// USE_MOTOR_PARAM, unless speed controllers are calibrated.
bool uses_motor_model(const Parameters& p);
/// RC_F_AXIS as an axis 0..2.
std::uint8_t throttle_axis(const Parameters& p);

}  // namespace rosflight::core
