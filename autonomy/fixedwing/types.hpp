// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <cmath>

#include "autonomy/common/state_estimate.hpp"
#include "autonomy/common/types.hpp"

/// Types of guidance and control of a fixed wing, beside autonomy/common/types.hpp.
/// Course chi: direction of the velocity over ground, heading psi: of the nose; both from north,
/// clockwise. Height h is up, so h = -p_W.z. A turn is +1 to the right (clockwise from above), -1
/// to the left.
namespace rosflight::autonomy::fixedwing {

using Vector2 = Eigen::Vector2d;  ///< North, east [m].

/// Unit vector along a course.
inline Vector2 along(double course_rad) {
  return {std::cos(course_rad), std::sin(course_rad)};
}
/// Unit vector to the right of a course.
inline Vector2 right_of(double course_rad) {
  return {-std::sin(course_rad), std::cos(course_rad)};
}
/// Course of a direction, within +-pi; 0 for the zero vector.
inline double course_of(const Vector2& direction) {
  return std::atan2(direction.y(), direction.x());
}

/// Ground speed by airspeed that plans count on in the strongest head wind.
inline constexpr double kMinOverGround = 0.3;

/// Horizontal position and course.
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
  Vector3 p_W{Vector3::Zero()};
  Passing passing{Passing::kFillet};
  double course_rad{};       ///< kDubins only.
  double airspeed_m_s{};     ///< On the leg to it; 0: the vehicle's cruise.
  int turn{};                ///< kCircle only: +1, -1, or 0 for the shorter path.
  double hold_s{};           ///< kCircle only: minimum time on the circle, in still air.
  bool hold_indefinitely{};  ///< kCircle only: never go on.
};

/// The path that the follower flies in one step: ROSflight's CurrentPath, with the altitude of arcs in
/// c.
struct CurrentPath {
  bool valid{};
  bool circle{};
  double airspeed_m_s{};
  Vector3 r_W{Vector3::Zero()};   ///< Line: a point of it,
  Vector3 q_W{Vector3::UnitX()};  ///< and its unit direction.
  Vector3 c_W{Vector3::Zero()};   ///< Circle: centre; c_W.z is the reference here and now.
  double radius_m{};              ///< Circle; > 0.
  int turn{1};                    ///< Circle: +1 clockwise from above, -1 not.
  double slope{};                 ///< Circle: altitude gained per horizontal distance.
};

/// Output of the follower, input of the controller: ROSflight's ControllerCommands.
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
