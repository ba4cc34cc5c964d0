// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <string>

#include "autonomy/estimation/estimator_config.hpp"
#include "autonomy/fixedwing/config.hpp"
#include "autonomy/multirotor/config.hpp"
#include "companion/parameter.hpp"
#include "sim/multirotor/multirotor_parameters.hpp"
#include "sim/vehicle.hpp"

/// What guidance, control and estimation take from a vehicle file: the sections `autonomy` and
/// `firmware` with the facts of the other sections they depend on. Shared by `rosflight fly` and
/// the ROS nodes. All of it throws config::Error, one line.
namespace rosflight::flight {

bool is_fixed_wing(const sim::Vehicle& vehicle);

/// Rotors of a multirotor, propulsion of a fixed wing.
sim::MultirotorParameters read_rotors(const sim::Vehicle& vehicle);

/// Parameters of a vehicle's section `firmware`, typed and in range. What the section leaves out
/// about motors and propellers comes from the section `rotors`; with `PRIMARY_MIXER: geometry` the
/// mixer of a multirotor does too (mixer_parameters()): forces in N, torques in N m.
companion::ParameterSet read_firmware_parameters(const sim::Vehicle& vehicle);

/// The parameters that decide what thrust the firmware makes of a throttle.
inline constexpr std::array kThrustParameters{"PRIMARY_MIXER",   "USE_MOTOR_PARAM",  "RC_MAX_THR",
                                              "NUM_MOTORS",      "MOTOR_RESISTANCE", "MOTOR_KV",
                                              "NO_LOAD_CURRENT", "PROP_DIAMETER",    "PROP_CT",
                                              "PROP_CQ",         "BATT_VOLT_MAX"};

/// Value a parameter will have with `set` in force.
double firmware_value(const companion::ParameterSet& set, const std::string& name);

autonomy::multirotor::AutonomyConfig read_multirotor_autonomy(
    const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors,
    const companion::ParameterSet& firmware);
autonomy::multirotor::AutonomyConfig read_multirotor_autonomy(const sim::Vehicle& vehicle);

autonomy::fixedwing::AutonomyConfig read_fixedwing_autonomy(const sim::Vehicle& vehicle);

/// Configuration for either kind of vehicle; declination by wmm2025_declination.
autonomy::estimation::EstimatorConfig read_estimator(const sim::Vehicle& vehicle);

/// What the magnetic model of the world's national surveys says at a fix: WMM2025, within its
/// years.
double wmm2025_declination(const autonomy::estimation::GnssSample& fix);

}  // namespace rosflight::flight
