// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <map>
#include <string>

#include "flight/flight.hpp"

namespace rosflight::bench::faults {

/// Times of the phases of a flight [s], by name:
///
///     multirotor   armed     just armed               fixed wing   roll      half way to lifting off
///                  take-off  climbing, half way                    lift      just off the ground
///                  hold      waiting before its path               climb     half of the climb
///                  leg       middle of the second                  leg       middle of the second
///                  turn      at the second waypoint                arc       at the first waypoint
///                  landing   half of the descent                   approach  half of the approach
///                  touch     just before the ground                flare     in the flare
///
/// Equal seeds give equal flights, so those of a flight without faults are those of every flight
/// until its fault begins.
using PhaseTimes = std::map<std::string, double>;

/// Flies `setup`, which has no faults, and notes when each phase was.
/// @throws std::runtime_error  the flight does not succeed.
PhaseTimes find_phases(const flight::FlightSetup& setup);

}  // namespace rosflight::bench::faults
