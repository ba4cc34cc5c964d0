// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "autonomy/fixedwing/segment.hpp"

namespace rosflight::autonomy::quadplane {

/// A route of straights whose corners are arcs of one radius, from a point to a point.
///
/// A corner that turns by the angle d takes R tan(d/2) of both of its legs. Height changes linearly along the
/// straights and stays on arcs.
class Path {
 public:
  Path() = default;
  /// @param points_W  start, then the waypoints.
  /// @param radius_m  of all corners.
  /// @returns the index of the first leg (1: from the start to the first waypoint) that is too short for the
  ///     corners at its ends, or 0: the path is built.
  std::size_t build(const std::vector<Vector3>& points_W, double radius_m);

  struct Point {
    Vector3 p_W{Vector3::Zero()};
    double course_rad{};
    double slope{};          ///< Height gained per distance.
    double curvature_1_m{};  ///< > 0: turns right.
    double left_m{};         ///< Along the path to its end.
    std::size_t waypoint{};  ///< Index of the next one.
  };
  /// Begins at the start, or where the path is next to a position.
  void restart() { at_ = 0, s_m_ = 0.0; }
  void rejoin(const Vector3& p_W);
  /// Advances to the point next to p_W, never back to an earlier segment.
  const Point& follow(const Vector3& p_W);
  bool empty() const { return segments_.empty(); }

 private:
  Point point() const;

  std::vector<fixedwing::Segment> segments_;
  std::vector<double> after_m_;  ///< Length of all segments behind this one.
  std::size_t at_{};
  double s_m_{};
  Point now_{};
};

}  // namespace rosflight::autonomy::quadplane
