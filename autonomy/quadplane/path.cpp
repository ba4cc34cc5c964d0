// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/quadplane/path.hpp"

#include <algorithm>
#include <cmath>

#include "autonomy/common/angles.hpp"
#include "autonomy/fixedwing/dubins.hpp"

namespace rosflight::autonomy::quadplane {

using fixedwing::along;
using fixedwing::course_of;
using fixedwing::Pose;
using fixedwing::Segment;
using fixedwing::swept_angle;
using fixedwing::Tangent;
using fixedwing::TurnCircle;
using fixedwing::Vector2;

void Path::clear() {
  segments_.clear();
  begin_m_.clear();
  knots_.clear();
  length_m_ = 0.0;
  restart();
}

void Path::add(const Segment& segment) {
  segments_.push_back(segment);
  begin_m_.push_back(length_m_);
  length_m_ += segment.length_m;
}

std::size_t Path::build(const std::vector<Vector3>& points_W, double radius_m) {
  clear();
  const std::size_t legs = points_W.size() - 1;
  knots_.push_back({0.0, -points_W.front().z()});
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
    straight.waypoint = k;
    add(straight);
    const double arc_m = radius_m * std::abs(turn);
    knots_.push_back({length_m_ + 0.5 * arc_m, -points_W[k + 1].z()});
    if (turn != 0.0) {
      Segment arc;
      arc.start = {straight.point_at(straight_m), course};
      arc.radius_m = std::copysign(radius_m, turn);
      arc.length_m = arc_m;
      arc.waypoint = k;
      add(arc);
    }
    taken_m = corner_m;
  }
  now_ = point();
  return 0;
}

void Path::go_to(const Vector3& p_W, double course_rad, double radius_m, const Vector3& goal_W) {
  clear();
  const TurnCircle goal{goal_W.head<2>(), 0.0};
  const Pose here{p_W.head<2>(), course_rad};
  Segment turn;
  Tangent tangent;
  for (const double radius : {radius_m, -radius_m}) {
    const std::optional<Tangent> leaves = Tangent::between(TurnCircle::at(here, radius), goal);
    if (!leaves) continue;
    const double length_m = std::abs(radius) * swept_angle(course_rad, leaves->course_rad, radius);
    if (tangent.length_m > 0.0 && length_m >= turn.length_m) continue;
    turn.start = here;
    turn.radius_m = radius;
    turn.length_m = length_m;
    tangent = *leaves;
  }
  if (turn.length_m > 0.0) add(turn);
  Segment straight;
  straight.start = {goal.centre_m - tangent.length_m * along(tangent.course_rad),
                    tangent.course_rad};
  straight.length_m = tangent.length_m;
  add(straight);
  knots_ = {{0.0, -p_W.z()}, {length_m_, -goal_W.z()}};
  now_ = point();
}

double Path::steepest(std::size_t leg) const {
  const Knot& from = knots_[leg - 1];
  const Knot& to = knots_[leg];
  return 1.5 * std::abs(to.height_m - from.height_m) / (to.s_m - from.s_m);
}

Path::Point Path::point() const {
  const Segment& segment = segments_[at_];
  const double s_m = std::clamp(s_m_, 0.0, segment.length_m);
  const double whole_m = begin_m_[at_] + s_m;
  Point out;
  std::size_t k = 1;
  while (k + 1 < knots_.size() && knots_[k].s_m <= whole_m) ++k;
  const Knot& from = knots_[k - 1];
  const Knot& to = knots_[k];
  const double rise_m = to.height_m - from.height_m;
  const double length_m = to.s_m - from.s_m;
  const double x = length_m > 0.0 ? std::clamp((whole_m - from.s_m) / length_m, 0.0, 1.0) : 1.0;
  out.p_W << segment.point_at(s_m), -(from.height_m + rise_m * x * x * (3.0 - 2.0 * x));
  if (x > 0.0 && x < 1.0) {
    out.slope = 6.0 * rise_m / length_m * x * (1.0 - x);
    out.bend_1_m = 6.0 * rise_m / (length_m * length_m) * (1.0 - 2.0 * x);
  }
  out.course_rad = wrap_angle(segment.course_at(s_m));
  out.curvature_1_m = segment.straight() ? 0.0 : 1.0 / segment.radius_m;
  out.left_m = length_m_ - begin_m_[at_] - s_m_;
  out.waypoint = segment.waypoint;
  out.before_m =
      knots_[std::min(segment.waypoint + 1, knots_.size() - 1)].s_m - begin_m_[at_] - s_m_;
  return out;
}

double Path::curvature_ahead(double distance_m) const {
  std::size_t k = at_;
  while (k + 1 < segments_.size() && begin_m_[at_] + s_m_ + distance_m >= begin_m_[k + 1]) ++k;
  return segments_[k].straight() ? 0.0 : 1.0 / segments_[k].radius_m;
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
