// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/segment.hpp"

#include <algorithm>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::fixedwing {

double Segment::course_at(double s_m) const {
  return straight() ? start.course_rad : start.course_rad + s_m / radius_m;
}

Vector2 Segment::point_at(double s_m) const {
  if (straight()) return start.p_m + s_m * along(start.course_rad);
  return circle().point(course_at(s_m));
}

double Segment::height_at(double s_m) const {
  if (height0_m == height1_m || !(length_m > 0.0)) return height1_m;
  return height0_m + (height1_m - height0_m) * std::clamp(s_m / length_m, 0.0, 1.0);
}

double Segment::slope() const {
  return height0_m == height1_m || !(length_m > 0.0) ? 0.0 : (height1_m - height0_m) / length_m;
}

double Segment::progress(const Vector2& p_m, double guess_m) const {
  if (straight()) return (p_m - start.p_m).dot(along(start.course_rad));
  // p - c = -R right_of(chi) at the foot of p.
  const Vector2 inward = (circle().centre_m - p_m) * (radius_m > 0.0 ? 1.0 : -1.0);
  if (inward.squaredNorm() < 1e-12) return guess_m;
  const double course = std::atan2(-inward.x(), inward.y());
  return guess_m + wrap_angle(course - course_at(guess_m)) * radius_m;
}

double Segment::cross_track_m(const Vector2& p_m) const {
  if (straight()) return (p_m - start.p_m).dot(right_of(start.course_rad));
  const double outside_m = (p_m - circle().centre_m).norm() - std::abs(radius_m);
  return radius_m > 0.0 ? -outside_m : outside_m;
}

CurrentPath Segment::path_at(double s_m) const {
  CurrentPath out;
  out.valid = true;
  out.airspeed_m_s = airspeed_m_s;
  out.slope = slope();
  if (straight()) {
    out.r_W << start.p_m, -height0_m;
    out.q_W << along(start.course_rad), -out.slope;
    out.q_W.normalize();
    return out;
  }
  out.circle = true;
  out.c_W << circle().centre_m, -height_at(s_m);
  out.radius_m = std::abs(radius_m);
  out.turn = radius_m > 0.0 ? 1 : -1;
  return out;
}

}  // namespace rosflight::autonomy::fixedwing
