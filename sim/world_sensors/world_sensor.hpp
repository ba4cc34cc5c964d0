// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "config/strict_yaml.hpp"
#include "sim/random.hpp"
#include "sim/sample_clock.hpp"
#include "sim/types.hpp"
#include "sim/world/shapes.hpp"

/// Sensors of the companion computer and of the room: they measure the world around the vehicle, or the vehicle
/// from outside, and none of it passes through the flight controller (that is sim/sensors).
namespace rosflight::sim {

/// Ranges at equal angles about the down axis of the sensor's frame (front-right-down); angles are positive to the
/// left, as a LaserScan has them. -inf: nearer than min_m, +inf: nothing up to max_m, NaN: no reading.
struct ScanSample {
  Time stamp{};
  double angle_min_rad{};
  double angle_step_rad{};
  double min_m{};
  double max_m{};
  std::vector<float> ranges_m;
};

/// Depths along the front axis of a pinhole camera, row by row from the top left corner; as in ScanSample.
struct DepthSample {
  Time stamp{};
  int width_px{};
  int height_px{};
  double focal_px{};
  std::vector<float> depths_m;
};

/// Where an outside system has the vehicle.
struct PoseSample {
  Time stamp{};
  Vector3 p_W{Vector3::Zero()};
  Quaternion q_WB{Quaternion::Identity()};
};

/// What a sensor of the world may deliver; each has a standard message (messages/world_sensors.hpp).
using WorldSample = std::variant<ScanSample, DepthSample, PoseSample, hal::RangeSample>;

/// Where a sensor is on the vehicle.
struct Mounting {
  Vector3 position_m{Vector3::Zero()};    ///< In body axes from the origin of the vehicle file.
  Vector3 rotation_deg{Vector3::Zero()};  ///< Roll, pitch, yaw: turns body axes into the sensor's.

  /// Takes coordinates of the sensor's frame S to body axes: R_z(yaw) R_y(pitch) R_x(roll).
  Matrix3 R_BS() const;
};

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
  const config::Section&
      section;       ///< Its own, without `type`; whoever makes the sensor finishes it.
  std::string name;  ///< Key of the section and first part of its topics.
  const world::WorldShapes& shapes;  ///< Outlives the sensor.
  const RandomSource& random;
  Vector3 centre_of_mass_B{Vector3::Zero()};  ///< From the origin of the vehicle file.
  Time step{};                                ///< Of the simulation.

  /// From the centre of mass, at which Truth is.
  Vector3 from_centre_of_mass(const Mounting& mounting) const {
    return mounting.position_m - centre_of_mass_B;
  }
};

/// Makes a sensor. @throws config::Error  what is wrong in its section.
using WorldSensorFactory = std::function<std::unique_ptr<WorldSensor>(const WorldSensorSite&)>;

}  // namespace rosflight::sim
