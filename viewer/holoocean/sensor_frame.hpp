// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/types.hpp"
#include "viewer/holoocean/scenario.hpp"

namespace rosflight::viewer::holoocean {

/// A picture: row after row from the top left, 4 bytes per pixel in the order blue, green, red, alpha.
struct Image {
  std::string sensor;
  SensorType type{SensorType::kRgbCamera};
  int width_px{};
  int height_px{};
  std::vector<std::uint8_t> bgra;
};

/// Distance that a pixel of a depth camera encodes [m]: (R + 256 G + 65536 B) / (2^24 - 1) * 1000.
double depth_m(const Image& image, int column, int row);

/// Distances along rays. Ray i points 360 i / n degrees to the left of the sensor's x axis, raised by the elevation.
struct Ranges {
  std::string sensor;
  double max_range_m{};
  double elevation_rad{};
  std::vector<float> ranges_m;  ///< Infinity: nothing within max_range_m.
};

/// What the sensors of the engine measured at one simulated time. A sensor appears only when it is due.
struct SensorFrame {
  std::chrono::nanoseconds
      time{};            ///< Simulated time of the state that was measured, as it was given.
  std::uint64_t tick{};  ///< Number of the tick since the last reset; the first is 1.
  std::vector<Image> images;
  std::vector<Ranges> ranges;
  // Where the engine has the aircraft, in our frames: its collision test may have stopped the motion.
  std::optional<sim::Vector3> p_W;
  std::optional<sim::Quaternion> q_WB;
  std::optional<sim::Vector3> v_W;  ///< Velocity over ground in W [m/s].
  std::optional<bool> in_contact;   ///< Reported only: the flight goes on.
};

}  // namespace rosflight::viewer::holoocean
