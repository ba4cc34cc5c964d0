// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "sim/vehicle.hpp"

namespace rosflight::flight {

/// Parts of the model that vehicle_sdf() writes.
enum class SdfModel {
  kOneLink,  ///< The body alone with the inertia of the file, for an engine that moves it under our forces.
  kWithJoints,  ///< With a joint for each rotor and control surface, as Gazebo's programs accept it.
};

/// A vehicle file as a model of the Simulation Description Format, SDF 1.9 (http://sdformat.org/spec).
///
/// Link `base_link`: forward-left-up axes at the centre of mass, mass and inertia of the file. Collisions: a sphere
/// inside each point of the gear, tangent to it; boxes for body, wing and propellers (the square inside the disc). The friction of the spheres is that of
/// the section `ground`; wheels roll along body x. Stiffness and damping are not written: engines differ in what they make of
/// them.
///
/// Rotors turn about their thrust direction, surfaces about a hinge in a position that is drawn only: a vehicle file
/// has none. An inertia that no body can have, which the reader of vehicle files allows up to 2 %, is rejected by sdformat: with
/// joints the largest principal moment is cut to the sum of the others. Each of these links has kJointMass_kg, which `base_link` has less, so that the sum is that of the file.
///
/// @param name  of the model. @throws config::Error
std::string vehicle_sdf(const sim::Vehicle& vehicle, const std::string& name,
                        SdfModel model = SdfModel::kWithJoints);

/// The element <model> of it alone. @param inside  goes first into it.
std::string vehicle_model_element(const sim::Vehicle& vehicle, const std::string& name,
                                  SdfModel model, const std::string& inside);

inline constexpr double kContactRadius_m = 0.02;  ///< Radius of the spheres at the gear.
inline constexpr double kJointMass_kg = 1e-5;

}  // namespace rosflight::flight
