// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "config/strict_yaml.hpp"
#include "sim/random.hpp"
#include "sim/sample_clock.hpp"
#include "sim/types.hpp"
#include "sim/world/shapes.hpp"
#include "sim/world_sensors/samples.hpp"

/// Sensors of the companion computer and of the room: they measure the world around the vehicle, or the vehicle
/// from outside, and none of it passes through the flight controller (that is sim/sensors).
namespace rosflight::sim {

/// Takes coordinates of the sensor's frame S to body axes: R_z(yaw) R_y(pitch) R_x(roll).
Matrix3 R_BS(const Mounting& mounting);

class WorldSensor {
 public:
  virtual ~WorldSensor() = default;
  /// Call once per step. @returns the sample that became available at truth.time, valid until the next
  /// call; nullptr: none.
  virtual const WorldSample* step(const Truth& truth) = 0;
  /// nullptr: not on the vehicle.
  virtual const Mounting* mounting() const = 0;
};

/// What a sensor is made of.
struct WorldSensorSite {
  const config::Section& section;    ///< Its own, without `type`; its maker finishes it.
  std::string name;                  ///< Key of the section and first part of its topics.
  const world::WorldShapes& shapes;  ///< Outlives the sensor.
  const RandomSource& random;
  Vector3 centre_of_mass_B{Vector3::Zero()};  ///< From the origin of the vehicle file.
  Time step{};                                ///< Step of the simulation.

  /// From the centre of mass, at which Truth is.
  Vector3 from_centre_of_mass(const Mounting& mounting) const {
    return mounting.position_m - centre_of_mass_B;
  }
};

/// Makes a sensor. @throws config::Error  what is wrong in its section.
using WorldSensorFactory = std::function<std::unique_ptr<WorldSensor>(const WorldSensorSite&)>;

}  // namespace rosflight::sim
