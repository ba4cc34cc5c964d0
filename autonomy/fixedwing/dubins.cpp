// SPDX-License-Identifier: BSD-3-Clause
#include "autonomy/fixedwing/dubins.hpp"

#include <algorithm>

namespace rosflight::autonomy::fixedwing {
namespace {

constexpr double kSame_m = 1e-9;
constexpr double kSameAngle_rad = 1e-9;

DubinsPath assemble(DubinsWord word, const std::array<DubinsPath::Part, 3>& parts) {
  DubinsPath path{word, parts, 0.0};
  for (const DubinsPath::Part& part : parts) path.length_m += part.length_m;
  return path;
}

std::optional<DubinsPath> over_straight(DubinsWord word, const Pose& from, const Pose& to,
                                        double s1, double s2) {
  const TurnCircle first = TurnCircle::at(from, s1);
  const TurnCircle last = TurnCircle::at(to, s2);
  const bool same = s1 == s2 && (first.centre_m - last.centre_m).norm() < kSame_m;
  const auto tangent =
      same ? std::optional<Tangent>({to.course_rad, 0.0}) : Tangent::between(first, last);
  if (!tangent) return {};
  const double chi = tangent->course_rad;
  const double turn1 = swept_angle(from.course_rad, chi, s1);
  const double turn2 = swept_angle(chi, to.course_rad, s2);
  return assemble(word, {{{from, s1, std::abs(s1) * turn1},
                          {{first.point(chi), chi}, 0.0, tangent->length_m},
                          {{last.point(chi), chi}, s2, std::abs(s2) * turn2}}});
}

std::optional<DubinsPath> over_arc(DubinsWord word, const Pose& from, const Pose& to, double s) {
  const TurnCircle first = TurnCircle::at(from, s);
  const TurnCircle last = TurnCircle::at(to, s);
  const Vector2 d = last.centre_m - first.centre_m;
  const double radius_m = std::abs(s);
  const double gap_m = d.norm();
  if (gap_m > 4.0 * radius_m || gap_m < kSame_m) return {};
  // The middle circle touches both: its centre is 2 R from each, on the side that makes the middle
  // arc longer than half a circle, which is the right of d for R-L-R and the left for L-R-L.
  const double height_m =
      std::sqrt(std::max(4.0 * radius_m * radius_m - 0.25 * gap_m * gap_m, 0.0));
  const double sense = s > 0.0 ? 1.0 : -1.0;
  const Vector2 middle =
      0.5 * (first.centre_m + last.centre_m) + sense * height_m * right_of(course_of(d));
  const auto course_where = [&](const Vector2& centre) {
    // On a circle of signed radius s, p - c = -s right_of(chi).
    const Vector2 outward = (middle - centre) * (-sense / (2.0 * radius_m));
    return std::atan2(-outward.x(), outward.y());
  };
  const double chi1 = course_where(first.centre_m);
  const double chi2 = course_where(last.centre_m);
  return assemble(
      word, {{{from, s, radius_m * swept_angle(from.course_rad, chi1, s)},
              {{first.point(chi1), chi1}, -s, radius_m * swept_angle(chi1, chi2, -s)},
              {{last.point(chi2), chi2}, s, radius_m * swept_angle(chi2, to.course_rad, s)}}});
}

}  // namespace

std::optional<Tangent> Tangent::between(const TurnCircle& from, const TurnCircle& to) {
  const Vector2 d = to.centre_m - from.centre_m;
  const double offset = to.radius_m - from.radius_m;
  const double left_sq = d.squaredNorm() - offset * offset;
  if (left_sq < 0.0 || d.norm() < kSame_m) return {};
  const double length_m = std::sqrt(left_sq);
  return Tangent{course_of(d) - std::atan2(offset, length_m), length_m};
}

double swept_angle(double from_rad, double to_rad, double radius_m) {
  constexpr double kTurn = 2.0 * kPi;
  const double change = radius_m >= 0.0 ? to_rad - from_rad : from_rad - to_rad;
  const double swept = change - kTurn * std::floor(change / kTurn);
  return swept > kTurn - kSameAngle_rad ? 0.0 : swept;
}

std::optional<DubinsPath> dubins_path(DubinsWord word, const Pose& from, const Pose& to,
                                      double radius_m) {
  switch (word) {
    case DubinsWord::kRsr:
      return over_straight(word, from, to, radius_m, radius_m);
    case DubinsWord::kRsl:
      return over_straight(word, from, to, radius_m, -radius_m);
    case DubinsWord::kLsr:
      return over_straight(word, from, to, -radius_m, radius_m);
    case DubinsWord::kLsl:
      return over_straight(word, from, to, -radius_m, -radius_m);
    case DubinsWord::kRlr:
      return over_arc(word, from, to, radius_m);
    case DubinsWord::kLrl:
      return over_arc(word, from, to, -radius_m);
  }
  return {};
}

DubinsPath shortest_dubins_path(const Pose& from, const Pose& to, double radius_m) {
  DubinsPath best;
  best.length_m = kInfinity;
  for (std::size_t k = 0; k < kDubinsWords; ++k) {
    const auto path = dubins_path(static_cast<DubinsWord>(k), from, to, radius_m);
    if (path && path->length_m < best.length_m - kSame_m) best = *path;
  }
  return best;
}

}  // namespace rosflight::autonomy::fixedwing
