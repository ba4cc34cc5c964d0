// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <map>
#include <string>

#include "flight/flight.hpp"

namespace rosflight::bench::faults {

/// Times of a flight [s]; phases by name:
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
struct Phases {
  std::map<std::string, double> begin_s;
  double armed_s{};
  double touchdown_s{};
};

/// Flies `setup`, which has no faults, and notes when each phase was.
/// @param also  called in each step.
/// @throws std::runtime_error  the flight does not succeed.
Phases find_phases(const flight::FlightSetup& setup,
                   const std::function<void(flight::Flight&, sim::Time)>& also = {});

}  // namespace rosflight::bench::faults
