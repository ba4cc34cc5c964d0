// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/types.hpp"

/// The vocabulary of guidance and control of a multirotor, on top of autonomy/common/types.hpp;
/// "v1" is N turned by the heading only.
namespace rosflight::autonomy::multirotor {

/// Where the vehicle is, from an estimator or from truth.
struct State {
  Vector3 p_W{Vector3::Zero()};
  Vector3 v_W{Vector3::Zero()};
  Quaternion q_WB{Quaternion::Identity()};  ///< Normalised by the source.
  Vector3 w_B{Vector3::Zero()};
  bool horizontal{true};  ///< false: position and velocity north and east mean nothing.
  bool aided{true};       ///< false: they have been dead-reckoned for a while: hold, do not follow.
  bool vertical{true};    ///< false: altitude and vertical speed mean nothing.
};

/// One target, always local: geodetic input is converted when a mission is loaded (geodesy.hpp).
struct Waypoint {
  WaypointType type{WaypointType::kGoto};
  Vector3 p_W{Vector3::Zero()};
  double psi_rad{};  ///< Heading on arrival; any finite angle.
  double speed_m_s{
      kInfinity};   ///< Highest speed on the leg towards it; the path's own limit holds too.
  double hold_s{};  ///< Hold only: time to stay after arrival.
  bool hold_indefinitely{};  ///< Hold only: never go on.

  // A figure of eight from here to here (figure_eight.hpp), where figure_turns > 0.
  int figure_turns{};
  double figure_radius_m{};
  double figure_course_rad{};
};

/// A point of a trajectory: what the follower is to be at, now.
struct Trajectory {
  Vector3 p_W{Vector3::Zero()};
  Vector3 v_W{Vector3::Zero()};
  Vector3 a_W{Vector3::Zero()};
  Vector3 j_W{Vector3::Zero()};  ///< Jerk, the derivative of a_W; zero where it is unknown.
  double psi_rad{};              ///< In (-pi, pi].
  double psi_dot_rad_s{};
  double psi_ddot_rad_s2{};
};

/// What the four numbers of a ControllerCommand are (ROSflight 2.x, roscopter ControllerCommand).
/// North, east, down: position [m] or velocity [m/s]; accelerations in units of gravity, in v1; torques [N
/// m].
enum class ControlMode : std::uint8_t {
  kNposEposDposYaw = 0,
  kNvelEvelDposYawrate = 1,
  kFaccRaccDaccYawrate = 2,
  kNvelEvelDvelYawrate = 3,
  kNposEposDvelYaw = 4,
  kRollPitchYawThrottle = 5,  ///< Throttle as the firmware takes it, 0..1.
  kRollPitchYawrateThrottle = 6,
  kRollratePitchrateYawrateThrottle = 7,
  kPassThroughToMixer = 8,  ///< Qx, Qy, Qz [N m], thrust [N], positive up.
  kRollPitchYawThrust = 9,  ///< Thrust [N], positive up.
  kRollPitchYawrateThrust = 10,
  kRollratePitchrateYawrateThrust = 11
};
inline constexpr std::size_t kControlModes = 12;

struct ControllerCommand {
  ControlMode mode{ControlMode::kNposEposDposYaw};
  std::array<double, 4> cmd{};
  bool valid{false};
};

}  // namespace rosflight::autonomy::multirotor
