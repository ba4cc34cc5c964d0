// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "base/constants.hpp"
#include "sim/world_sensors/beam_errors.hpp"
#include "sim/world_sensors/make_world_sensor.hpp"

namespace rosflight::sim {

/// A lidar that scans one plane, all rays at the same moment: ray i of n leaves the sensor at
///
///     a_i = a_min + i (a_max - a_min)/(n - 1),   d_S = (cos a_i, -sin a_i, 0)                  (1)
///
/// in its frame S (front-right-down), so angles are positive to the left. Its range is the distance to the nearest
/// shape of the world with the errors of beam_errors.hpp. A scanner that turns takes its rays one after the other; at
/// 1 m/s and 10 scans a second that is up to 10 cm, and not modelled.
class Lidar {
 public:
  using Sample = ScanSample;

  struct Config {
    Timing timing{true, Time{100'000}, Time{0}, Time{0}};
    Mounting mounting;
    int rays{181};
    double angle_min_rad{-90.0 * base::kRadPerDeg};
    double angle_max_rad{90.0 * base::kRadPerDeg};
    BeamErrorParameters beam;
  };
  /// Its keys in a vehicle file, with units and limits.
  static config::Table<Config> parameters();

  /// The shapes of the site must outlive it.
  Lidar(const Config& config, const WorldSensorSite& site);
  /// (1). Always a sample.
  bool measure(const Truth& truth, Sample& sample);

 private:
  Config config_;
  const world::WorldShapes& shapes_;
  Vector3 position_B_;
  std::vector<Vector3> directions_B_;
  BeamErrors errors_;
};

}  // namespace rosflight::sim
