// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "autonomy/fixedwing/segment.hpp"

namespace rosflight::autonomy::quadplane {

/// A route of straights whose corners are arcs of one radius, from a point to a point.
///
/// A corner that turns by the angle d takes R tan(d/2) of both of its legs. A waypoint is passed in the middle of its
/// corner, at its height. Between two of them, L apart along the path, the height has no step in its slope:
///
///     h(x) = h0 + (h1 - h0) (3 x^2 - 2 x^3)      x = s/L from 0 to 1                       (1)
///
/// so the steepest slope is 1.5 (h1 - h0)/L, in the middle, and the path is level where it turns.
class Path {
 public:
  Path() = default;
  /// @param points_W  start, then the waypoints.
  /// @param radius_m  of all corners.
  /// @returns the index of the first leg (1: from the start to the first waypoint) that is too short for the
  ///     corners at its ends, or 0: the path is built.
  std::size_t build(const std::vector<Vector3>& points_W, double radius_m);
  /// From a position and a course to a point: the shorter turn, then straight on. One of both sides always leads there.
  /// @param radius_m  of the turn; 0: straight to the point.
  void go_to(const Vector3& p_W, double course_rad, double radius_m, const Vector3& goal_W);
  /// Largest slope between the waypoints `leg` - 1 and `leg` (0: the start).
  double steepest(std::size_t leg) const;

  struct Point {
    Vector3 p_W{Vector3::Zero()};
    double course_rad{};
    double slope{};          ///< Height gained per distance.
    double bend_1_m{};       ///< Change of the slope per distance.
    double curvature_1_m{};  ///< > 0: turns right.
    double left_m{};         ///< Along the path to its end.
    double
        before_m{};  ///< Along the path to the middle of the corner ahead, or of this one; < 0: behind it.
    std::size_t waypoint{};  ///< Index of the next one.
  };
  /// Begins at the start, or where the path is next to a position.
  void restart() { at_ = 0, s_m_ = 0.0; }
  void rejoin(const Vector3& p_W);
  /// Advances to the point next to p_W, never back to an earlier segment.
  const Point& follow(const Vector3& p_W);
  /// Curvature a distance further along the path.
  double curvature_ahead(double distance_m) const;
  bool empty() const { return segments_.empty(); }

 private:
  struct Knot {
    double s_m{};  ///< From the start.
    double height_m{};
  };
  void clear();
  void add(const fixedwing::Segment& segment);
  Point point() const;

  std::vector<fixedwing::Segment> segments_;
  std::vector<double> begin_m_;  ///< Where each segment begins, from the start.
  std::vector<Knot> knots_;      ///< The start, then every waypoint.
  double length_m_{};
  std::size_t at_{};
  double s_m_{};
  Point now_{};
};

}  // namespace rosflight::autonomy::quadplane
