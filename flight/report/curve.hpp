// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <span>
#include <string>
#include <vector>

namespace rosflight::report {

/// A point of a drawing in pixels, y downwards. NaN in either: a gap.
struct Point {
  double x{};
  double y{};
};

/// Appends SVG path data for a curve over time (x never falls). Of the points in one pixel column
/// only the lowest and the highest stay, in their order: no spike is lost and the size does not
/// depend on the length of the flight. Points alone between gaps become a dot (given round line
/// caps).
void append_time_curve(std::string& path_data, std::span<const Point> points);

/// Appends SVG path data for the area between two curves over the same times: of the points in one
/// pixel column the widest. A gap in either is a gap in the band.
void append_time_band(std::string& path_data, std::span<const Point> lower,
                      std::span<const Point> upper);

/// Appends SVG path data for a track in the plane, thinned to `tolerance` pixels (Douglas and
/// Peucker 1973).
void append_track(std::string& path_data, std::span<const Point> points, double tolerance);

}  // namespace rosflight::report
