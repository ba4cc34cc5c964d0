// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <optional>

#include "autonomy/fixedwing/types.hpp"

namespace rosflight::autonomy::fixedwing {

/// A circle with a sense: radius > 0 is flown to the right, < 0 to the left; 0 is a point.
struct TurnCircle {
  Vector2 centre_m{Vector2::Zero()};
  double radius_m{};

  /// The circle that touches a pose.
  static TurnCircle at(const Pose& pose, double radius_m) {
    return {pose.p_m + radius_m * right_of(pose.course_rad), radius_m};
  }
  /// Where it has this course. Any course for a point.
  Vector2 point(double course_rad) const { return centre_m - radius_m * right_of(course_rad); }
};

/// The straight line that leaves one circle and joins another, each in its sense.
///
/// With signed radii s1, s2 and d = c2 - c1 the line of course chi and length l has
///
///     d = l along(chi) + (s2 - s1) right_of(chi)
///     l = sqrt(|d|^2 - (s2 - s1)^2),  chi = atan2(d) - atan2(s2 - s1, l)                   (1)
///
/// which is RSR, LSL (s1 = s2), RSL, LSR (s1 = -s2) of Dubins' paths, and a tangent from or to a
/// point (s = 0). Beard & McLain, Small Unmanned Aircraft, 2012, sec. 11.2.1 list the four apart.
struct Tangent {
  double course_rad{};
  double length_m{};

  /// Nothing if the circles are too close: |d| < |s2 - s1|, or the same circle (no course).
  static std::optional<Tangent> between(const TurnCircle& from, const TurnCircle& to);
};

/// Angle flown on a circle of this sense from one course to another, in [0, 2 pi). A turn that
/// misses a whole one by less than 1e-9 is none.
double swept_angle(double from_rad, double to_rad, double radius_m);

/// The six words that can be shortest (Dubins 1957). R right, L left, S straight.
enum class DubinsWord : std::uint8_t { kRsr, kRsl, kLsr, kLsl, kRlr, kLrl };
inline constexpr std::size_t kDubinsWords = 6;

/// Three parts; each is an arc (signed radius) or a straight (radius 0).
struct DubinsPath {
  struct Part {
    Pose start{};
    double radius_m{};
    double length_m{};
  };
  DubinsWord word{};
  std::array<Part, 3> parts{};
  double length_m{};
};

/// The path of one word, if it exists. Middle arc of kRlr and kLrl: the one longer than half a
/// circle (Shkel & Lumelsky, Classification of the Dubins set, Robotics and Autonomous Systems 34,
/// 2001, sec. 2).
std::optional<DubinsPath> dubins_path(DubinsWord word, const Pose& from, const Pose& to,
                                      double radius_m);
/// The shortest of the six. There always is one; at equal length the first in the order above.
DubinsPath shortest_dubins_path(const Pose& from, const Pose& to, double radius_m);

}  // namespace rosflight::autonomy::fixedwing
