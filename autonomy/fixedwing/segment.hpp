// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>

#include "autonomy/fixedwing/dubins.hpp"
#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// One piece of a path: a straight or an arc of any number of turns, with a height that changes
/// linearly along the path.
///
///     straight:  p(s) = p0 + s along(chi0),          chi(s) = chi0
///     arc:       p(s) = c - R right_of(chi(s)),      chi(s) = chi0 + s/R,  c = p0 + R
///     right_of(chi0) h(s) = h0 + (h1 - h0) s/L,  held at both ends
///
/// with the signed radius R of TurnCircle.
struct Segment {
  Pose start{};
  double radius_m{};   ///< > 0 right, < 0 left, 0 straight.
  double length_m{};   ///< kInfinity: a circle for ever.
  double height0_m{};  ///< Up.
  double height1_m{};
  double airspeed_m_s{};
  std::size_t waypoint{};  ///< Whose leg it belongs to.
  bool passes_waypoint{};  ///< At its end.
  double corner_rad{};     ///< Change of course at its end that no arc takes care of.

  bool straight() const { return radius_m == 0.0; }
  TurnCircle circle() const { return TurnCircle::at(start, radius_m); }
  /// Course at distance s_m along the segment [rad]; grows past pi on an arc.
  double course_at(double s_m) const;
  /// Horizontal position, north and east [m].
  Vector2 point_at(double s_m) const;
  /// Height h(s), held at both ends [m].
  double height_at(double s_m) const;
  double slope() const;  ///< dh/ds

  /// Distance s of the point of this segment next to p; on an arc the one next to `guess_m`, so that
  /// whole turns count. Not clipped to the segment.
  double progress(const Vector2& p_m, double guess_m) const;
  /// Distance from the line or circle; positive to the right of the path.
  double cross_track_m(const Vector2& p_m) const;
  /// The path for the follower at distance s along the segment.
  CurrentPath path_at(double s_m) const;
};

}  // namespace rosflight::autonomy::fixedwing
