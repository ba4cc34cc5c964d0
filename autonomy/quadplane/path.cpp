// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/path.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"

namespace rosflight::autonomy::quadplane {

using fixedwing::along;
using fixedwing::course_of;
using fixedwing::Segment;
using fixedwing::Vector2;

std::size_t Path::build(const std::vector<Vector3>& points_W, double radius_m) {
  segments_.clear();
  after_m_.clear();
  restart();
  const std::size_t legs = points_W.size() - 1;
  double taken_m = 0.0;  // of this leg by the corner before it
  for (std::size_t k = 0; k < legs; ++k) {
    const Vector2 from = points_W[k].head<2>();
    const Vector2 leg = points_W[k + 1].head<2>() - from;
    const double course = course_of(leg);
    double turn = 0.0;
    double corner_m = 0.0;
    if (k + 1 < legs) {
      const Vector2 next = (points_W[k + 2] - points_W[k + 1]).head<2>();
      turn = wrap_angle(course_of(next) - course);
      corner_m = radius_m * std::tan(0.5 * std::abs(turn));
    }
    const double straight_m = leg.norm() - taken_m - corner_m;
    if (!(straight_m > 0.0)) return k + 1;
    Segment straight;
    straight.start = {from + taken_m * along(course), course};
    straight.length_m = straight_m;
    straight.height0_m = -points_W[k].z();
    straight.height1_m = -points_W[k + 1].z();
    straight.waypoint = k;
    segments_.push_back(straight);
    if (turn != 0.0) {
      Segment arc;
      arc.start = {straight.point_at(straight_m), course};
      arc.radius_m = std::copysign(radius_m, turn);
      arc.length_m = radius_m * std::abs(turn);
      arc.height0_m = arc.height1_m = straight.height1_m;
      arc.waypoint = k;
      segments_.push_back(arc);
    }
    taken_m = corner_m;
  }
  after_m_.assign(segments_.size(), 0.0);
  for (std::size_t k = segments_.size() - 1; k > 0; --k) {
    after_m_[k - 1] = after_m_[k] + segments_[k].length_m;
  }
  now_ = point();
  return 0;
}

Path::Point Path::point() const {
  const Segment& segment = segments_[at_];
  const double s_m = std::clamp(s_m_, 0.0, segment.length_m);
  Point out;
  out.p_W << segment.point_at(s_m), -segment.height_at(s_m);
  out.course_rad = wrap_angle(segment.course_at(s_m));
  out.slope = s_m > 0.0 && s_m < segment.length_m ? segment.slope() : 0.0;
  out.curvature_1_m = segment.straight() ? 0.0 : 1.0 / segment.radius_m;
  out.left_m = after_m_[at_] + segment.length_m - s_m_;
  out.waypoint = segment.waypoint;
  return out;
}

void Path::rejoin(const Vector3& p_W) {
  // A later leg may come past here too: this straight, its corner and the next straight count.
  const std::size_t end = std::min(at_ + 3, segments_.size());
  double nearest_m = kInfinity;
  for (std::size_t k = at_; k < end; ++k) {
    const Segment& segment = segments_[k];
    const double s_m =
        std::clamp(segment.progress(p_W.head<2>(), 0.5 * segment.length_m), 0.0, segment.length_m);
    const double distance_m = (segment.point_at(s_m) - p_W.head<2>()).norm();
    if (distance_m >= nearest_m) continue;
    nearest_m = distance_m;
    at_ = k;
    s_m_ = s_m;
  }
  now_ = point();
}

const Path::Point& Path::follow(const Vector3& p_W) {
  const bool last = at_ + 1 == segments_.size();
  s_m_ = segments_[at_].progress(p_W.head<2>(), s_m_);
  if (!last && s_m_ >= segments_[at_].length_m) {
    ++at_;
    s_m_ = segments_[at_].progress(p_W.head<2>(), 0.0);
  }
  now_ = point();
  return now_;
}

}  // namespace rosflight::autonomy::quadplane
