// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/fixedwing/fixedwing.hpp"

namespace rosflight::sim {

/// A rotor that pushes up carries the vehicle in hover; any other is a pusher.
bool lifts(const RotorParameters& rotor);

/// Forces and moments of a quad-plane: the sections of a fixed wing, whose rotors stand in any direction, and
/// the section `rotor_aero`, what lifting rotors and their booms add (the keys of a multirotor's `aero`). They
/// make one FixedWing, the module `quadplane`: wing, lifting rotors, pusher and battery act at once at every
/// airspeed, so no switch between two models lies in a transition. Left out: the rotors' wash on wing and tail.
/// Throws config::Error: no four lifting rotors, or none that pushes.
FixedWingParameters read_quadplane(const config::Section& vehicle);

}  // namespace rosflight::sim
