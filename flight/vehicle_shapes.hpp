// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "sim/multirotor/multirotor_parameters.hpp"
#include "sim/vehicle.hpp"

namespace rosflight::flight {

/// Boxes that stand for body and wing where a vehicle is drawn or collides, in forward-left-up axes at the centre of
/// mass. Of the body a vehicle file says nothing but where its parts are: it is half as long and wide as those reach.
struct VehicleShapes {
  sim::Vector3 body_m{sim::Vector3::Zero()};  ///< Edge lengths.
  sim::Vector3 wing_m{sim::Vector3::Zero()};  ///< Zero: no wing.

  /// @param rotors  those of the vehicle.
  VehicleShapes(const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors);
  bool has_wing() const { return wing_m.minCoeff() > 0.0; }
};

inline constexpr double kPlateThickness_m = 0.01;  ///< Thickness of wings and propeller discs.

/// Roll and pitch [rad] that turn z into the direction `axis`.
sim::Vector3 pointing(const sim::Vector3& axis);

}  // namespace rosflight::flight
