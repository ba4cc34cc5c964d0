// SPDX-License-Identifier: BSD-3-Clause
#include "flight/vehicle_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "flight/vehicle/quadplane_setup.hpp"
#include "flight/vehicle/vehicle_setup.hpp"

namespace rosflight::flight {
namespace {

using sim::Vector3;

Vector3 wing_size(const sim::Vehicle& vehicle) {
  const config::Section wing = vehicle.root().section("aero").section("wing");
  const auto length = [&wing](const char* key) {
    return wing.number(key, config::Range::at_least(0.0), 0.0);
  };
  return {length("chord_m"), length("span_m"), kPlateThickness_m};
}

}  // namespace

VehicleShapes::VehicleShapes(const sim::Vehicle& vehicle, const sim::MultirotorParameters& rotors) {
  constexpr double kMinReach_m = 0.1;
  Vector3 reach = Vector3::Constant(kMinReach_m);
  for (const auto& rotor : rotors.rotors) reach = reach.cwiseMax(rotor.p_B.cwiseAbs());
  for (const Vector3& contact : vehicle.ground().contacts_B)
    reach = reach.cwiseMax(contact.cwiseAbs());
  if (is_fixed_wing(vehicle) || is_quadplane(vehicle)) wing_m = wing_size(vehicle);
  const double width_m = std::min(reach.x(), reach.y());
  // The contacts of a fixed wing reach to its wing tips, which are no part of its body.
  body_m = wing_m.x() > 0.0 ? Vector3{reach.x(), 0.7 * wing_m.x(), 0.6 * wing_m.x()}
                            : Vector3{reach.x(), width_m, 0.25 * width_m};
}

Vector3 pointing(const Vector3& axis) {
  return {std::atan2(-axis.y(), std::hypot(axis.x(), axis.z())), std::atan2(axis.x(), axis.z()),
          0.0};
}

}  // namespace rosflight::flight
