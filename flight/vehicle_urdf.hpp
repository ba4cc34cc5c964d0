// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "flight/flight_setup.hpp"

namespace rosflight::flight {

/// The geometry of a vehicle file as a robot description (URDF, http://wiki.ros.org/urdf/XML), which
/// ROS tools draw: a body, a disc for each propeller, a wing, a ball where the gear touches the
/// ground. Frame `base_link`, forward-left-up at the centre of mass; every joint is fixed. Mass and
/// inertia are those of the file. Of the body the file says nothing but where its parts are: it is
/// half as long and wide as those reach.
std::string vehicle_urdf(const FlightSetup& setup);

}  // namespace rosflight::flight
