// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "base/constants.hpp"
#include "sim/world_sensors/beam_errors.hpp"
#include "sim/world_sensors/make_world_sensor.hpp"

namespace rosflight::sim {

/// A depth camera: a pinhole without distortion that looks along the front axis of its frame S (front-right-down). The
/// ray of the centre of pixel (u, v), counted from the top left, is along
///
///     d_S = (1, (u - c_u)/f, (v - c_v)/f),   c = (size - 1)/2,   f = (width/2)/tan(fov/2)        (1)
///
/// and its depth is the front component of the point that it meets, with the errors of beam_errors.hpp.
class DepthCamera {
 public:
  using Sample = DepthSample;

  struct Config {
    Timing timing{true, Time{100'000}, Time{0}, Time{0}};
    Mounting mounting;
    int width_px{64};
    int height_px{48};
    double fov_rad{87.0 * base::kRadPerDeg};  ///< Horizontal, between the outer edges of the image.
    BeamErrorParameters beam;
  };
  /// Its keys in a vehicle file, with units and limits.
  static config::Table<Config> parameters();

  /// The shapes of the site must outlive it.
  DepthCamera(const Config& config, const WorldSensorSite& site);
  /// (1). Always a sample.
  bool measure(const Truth& truth, Sample& sample);
  double focal_px() const { return focal_px_; }

 private:
  struct Pixel {
    Vector3 direction_B;
    double cosine;  ///< Cosine of the angle between ray and front axis.
  };
  Config config_;
  const world::WorldShapes& shapes_;
  Vector3 position_B_;
  double focal_px_;
  std::vector<Pixel> pixels_;
  BeamErrors errors_;
};

}  // namespace rosflight::sim
