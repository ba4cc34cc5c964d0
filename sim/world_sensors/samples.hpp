// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <variant>
#include <vector>

#include "sim/types.hpp"

/// What sensors of the world deliver.
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
};

}  // namespace rosflight::sim
