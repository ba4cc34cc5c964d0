// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/quadplane/config.hpp"
#include "companion/parameter.hpp"
#include "sim/vehicle.hpp"

/// What guidance and firmware take from the file of a quad-plane.
namespace rosflight::flight {

bool is_quadplane(const sim::Vehicle& vehicle);

/// Both mixers of a quad-plane, computed from its sections `rotors` and `surfaces`; forces in N, torques in N m.
///
///     primary     the lifting rotors alone: what the pilot's sticks, failsafe and firmware loops drive
///     secondary   axis 0: pusher; 2 to 5: the lifting rotors as in the primary;
///                 6, 7, 8: surfaces that roll right, pitch up, yaw right, -1 to 1
companion::ParameterSet quadplane_mixers(const sim::Vehicle& vehicle);

/// Throws config::Error, one line.
autonomy::quadplane::AutonomyConfig read_quadplane_autonomy(const sim::Vehicle& vehicle);

}  // namespace rosflight::flight
