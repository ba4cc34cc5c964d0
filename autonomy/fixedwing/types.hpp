// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/common/types.hpp"

/// The vocabulary of guidance and control of a fixed wing, on top of autonomy/common/types.hpp.
/// Course chi: direction of the velocity over ground, heading psi: of the nose; both from north,
/// clockwise. Height h is up, so h = -p_N.z. A turn is +1 to the right (clockwise from above), -1
/// to the left.
namespace rosflight::autonomy::fixedwing {

using Vector2 = Eigen::Vector2d;  ///< North, east [m].

/// Unit vector along a course, and the one to its right.
inline Vector2 along(double course_rad) {
  return {std::cos(course_rad), std::sin(course_rad)};
}
inline Vector2 right_of(double course_rad) {
  return {-std::sin(course_rad), std::cos(course_rad)};
}
inline double course_of(const Vector2& direction) {
  return std::atan2(direction.y(), direction.x());
}

/// A place with a course.
struct Pose {
  Vector2 p_m{Vector2::Zero()};
  double course_rad{};
};

/// How a waypoint is passed.
enum class Passing : std::uint8_t {
  kLine,    ///< Over it, with a corner: the next leg begins on the bisecting plane.
  kFillet,  ///< An arc rounds the corner off and stays inside of it.
  kDubins,  ///< Over it on a given course.
  kCircle   ///< Around it.
};

/// One target, always local: geodetic input is converted when a mission is loaded.
struct Waypoint {
  Vector3 p_N{Vector3::Zero()};
  Passing passing{Passing::kFillet};
  double course_rad{};       ///< kDubins only.
  double airspeed_m_s{};     ///< On the leg to it; 0: the vehicle's cruise.
  int turn{};                ///< kCircle only: +1, -1, or 0 for the shorter way.
  double hold_s{};           ///< kCircle only: least time on the circle, in still air.
  bool hold_indefinitely{};  ///< kCircle only: never go on.
};

/// What the follower flies at one moment: ROSflight's CurrentPath, with the height of arcs in c.
struct CurrentPath {
  bool valid{};
  bool circle{};
  double airspeed_m_s{};
  Vector3 r_N{Vector3::Zero()};   ///< Line: a point of it,
  Vector3 q_N{Vector3::UnitX()};  ///< and its unit direction.
  Vector3 c_N{Vector3::Zero()};   ///< Circle: centre; c_N.z is the reference here and now.
  double radius_m{};              ///< Circle; > 0.
  int turn{1};                    ///< Circle: +1 clockwise from above, -1 not.
  double slope{};                 ///< Circle: height gained per way over ground.
};

/// What the follower asks of the controller: ROSflight's ControllerCommands.
struct ControllerCommand {
  bool valid{};
  double airspeed_m_s{};
  double height_m{};
  double course_rad{};
  double roll_ff_rad{};   ///< Bank that turns as the path does.
  double climb_ff_m_s{};  ///< Climb of the path.
};

/// Control surfaces by effect: positive rolls right, pitches up, yaws right; -1 to 1. Throttle 0
/// to 1.
struct Surfaces {
  double aileron{};
  double elevator{};
  double rudder{};
  double throttle{};
};

}  // namespace rosflight::autonomy::fixedwing
