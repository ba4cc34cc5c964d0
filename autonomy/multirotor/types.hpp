// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

/// The vocabulary of guidance and control of a multirotor. Double precision, SI, radians.
/// N = local north-east-down, B = body front-right-down, q_NB takes B coordinates to N; "v1" is N
/// turned by the heading only. Nothing here knows the link, ROS or a clock: time comes in as
/// seconds.
namespace rosflight::autonomy {

using Vector3 = Eigen::Vector3d;
using Quaternion = Eigen::Quaterniond;

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kRadPerDeg = kPi / 180.0;

/// Where the vehicle is, from an estimator or from truth.
struct State {
  Vector3 p_N{Vector3::Zero()};
  Vector3 v_N{Vector3::Zero()};
  Quaternion q_NB{Quaternion::Identity()};  ///< Normalised by whoever fills it.
  Vector3 w_B{Vector3::Zero()};
};

enum class WaypointType : std::uint8_t { kHold = 0, kGoto = 1 };

/// One target, always local: geodetic input is converted when a mission is loaded (geodesy.hpp).
struct Waypoint {
  WaypointType type{WaypointType::kGoto};
  Vector3 p_N{Vector3::Zero()};
  double psi_rad{};  ///< Heading on arrival; any finite angle.
  double speed_m_s{
      kInfinity};   ///< Highest speed on the leg towards it; the path's own limit holds too.
  double hold_s{};  ///< Hold only: time to stay after arrival.
  bool hold_indefinitely{};  ///< Hold only: never go on.
};

/// A point of a trajectory: what the follower is to be at, now.
struct Trajectory {
  Vector3 p_N{Vector3::Zero()};
  Vector3 v_N{Vector3::Zero()};
  Vector3 a_N{Vector3::Zero()};
  Vector3 j_N{Vector3::Zero()};  ///< Jerk, the derivative of a_N; zero where nobody knows it.
  double psi_rad{};              ///< In (-pi, pi].
  double psi_dot_rad_s{};
  double psi_ddot_rad_s2{};
};

/// What the four numbers of a ControllerCommand are (ROSflight 2.x, roscopter ControllerCommand).
/// N, E, D: position [m] or velocity [m/s]; accelerations in units of gravity, in v1; torques [N
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

/// Entry meaning of a FirmwareCommand; the numbers are those of the link's offboard command.
enum class FirmwareMode : std::uint8_t {
  kPassThrough = 0,              ///< u = Fx, Fy, Fz [N], Qx, Qy, Qz [N m].
  kRatesThrottle = 1,            ///< u = throttle x, y, z, roll, pitch, yaw rate [rad/s].
  kRollPitchYawrateThrottle = 2  ///< u = throttle x, y, z, roll, pitch [rad], yaw rate [rad/s].
};

inline constexpr std::size_t kFirmwareEntries = 10;
inline constexpr std::uint16_t kIgnoreAll = 0x3FF;  ///< No entry valid: the pilot has the vehicle.

/// What goes to the flight controller, in the precision of the link.
struct FirmwareCommand {
  FirmwareMode mode{FirmwareMode::kPassThrough};
  std::uint16_t ignore{};  ///< Bit k set: entry k is not valid.
  std::array<float, kFirmwareEntries> u{};
};

/// Which axes the pilot holds, out of the firmware's override word.
struct PilotOverride {
  bool roll_pitch{};
  bool yaw{};
  bool throttle{};

  /// Bits as in ROSflight 2.x: 0x01 attitude switch, 0x02 throttle switch, 0x04 0x08 0x10 sticks X
  /// Y Z, 0x20 lower throttle wins, 0x40 0x80 0x100 0x200 offboard roll, pitch, yaw, throttle not
  /// active.
  static PilotOverride from_word(std::uint16_t word) {
    return {(word & 0x0CDU) != 0, (word & 0x111U) != 0, (word & 0x222U) != 0};
  }
  bool any() const { return roll_pitch || yaw || throttle; }
};

/// What the flight controller reports of itself.
struct Status {
  bool armed{};
  bool offboard{};  ///< Some entry of our command is in force.
  std::uint16_t rc_override{};
  double battery_voltage_V{};  ///< <= 0: unknown, the nominal voltage is assumed.
};

}  // namespace rosflight::autonomy
