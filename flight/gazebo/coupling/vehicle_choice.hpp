// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "flight/flight_setup.hpp"

namespace rosflight::flight::gazebo {

/// The vehicle of a choice: a name of vehicles/, or a path, which needs no project folder. @throws config::Error
sim::Vehicle open_vehicle(const FlightChoice& choice);

}  // namespace rosflight::flight::gazebo
