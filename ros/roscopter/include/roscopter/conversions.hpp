// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <roscopter_msgs/msg/controller_command.hpp>
#include <roscopter_msgs/msg/state.hpp>
#include <roscopter_msgs/msg/trajectory_command.hpp>
#include <roscopter_msgs/msg/waypoint.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/status.hpp>

#include "autonomy/common/angles.hpp"
#include "autonomy/common/geodesy.hpp"
#include "autonomy/common/state_estimate.hpp"
#include "autonomy/multirotor/types.hpp"

/// Messages of roscopter_msgs and the structs of autonomy/, in both directions. Frames and units
/// are the same on either side but for the velocity: body axes in a State, north-east-down inside.
namespace roscopter {

/// Vehicle of rosflight_sim that a node takes if it is given none, as the launch files do.
inline constexpr const char* kUsualVehicle = "multirotor";

namespace autonomy = rosflight::autonomy;

inline autonomy::Vector3 vector(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

inline std::array<float, 3> array(const autonomy::Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// A quaternion without length becomes one that is not finite, so that nobody flies on it.
inline autonomy::multirotor::State state_of(const roscopter_msgs::msg::State& m) {
  autonomy::multirotor::State state;
  state.p_W = vector({m.p_n, m.p_e, m.p_d});
  const autonomy::Quaternion q{m.quat.w, m.quat.x, m.quat.y, m.quat.z};
  state.q_WB.coeffs() = q.coeffs() / q.norm();
  state.v_W = state.q_WB * vector({m.v_x, m.v_y, m.v_z});
  state.w_B = vector({m.p, m.q, m.r});
  return state;
}

/// The origin of north, east, down; absent as long as the state does not tell it.
inline std::optional<autonomy::Geodetic> origin_of(const roscopter_msgs::msg::State& m) {
  if (m.initial_lat == 0.0 && m.initial_lon == 0.0 && m.initial_alt == 0.0) return {};
  return autonomy::Geodetic{m.initial_lat, m.initial_lon, m.initial_alt};
}

/// All but the header.
inline void fill(const autonomy::StateEstimate& in, const std::optional<autonomy::Geodetic>& origin,
                 roscopter_msgs::msg::State& m) {
  const auto p = array(in.p_W);
  const auto v = array(in.q_WB.conjugate() * in.v_W);
  const auto w = array(in.w_B);
  const auto b = array(in.gyro_bias_B);
  m.p_n = p[0], m.p_e = p[1], m.p_d = p[2];
  m.v_x = v[0], m.v_y = v[1], m.v_z = v[2];
  m.p = w[0], m.q = w[1], m.r = w[2];
  m.b_x = b[0], m.b_y = b[1], m.b_z = b[2];
  const autonomy::Quaternion& q = in.q_WB;
  const autonomy::RollPitch tilt = autonomy::RollPitch::of(q);
  m.phi = static_cast<float>(tilt.roll_rad);
  m.theta = static_cast<float>(tilt.pitch_rad);
  m.psi = static_cast<float>(autonomy::heading_of(q));
  m.quat.w = q.w(), m.quat.x = q.x(), m.quat.y = q.y(), m.quat.z = q.z();
  if (!origin) return;
  m.initial_lat = origin->latitude_deg;
  m.initial_lon = origin->longitude_deg;
  m.initial_alt = origin->altitude_m;
}

inline autonomy::multirotor::Trajectory trajectory_of(
    const roscopter_msgs::msg::TrajectoryCommand& m) {
  autonomy::multirotor::Trajectory out;
  out.p_W = vector(m.position);
  out.v_W = vector(m.velocity);
  out.a_W = vector(m.acceleration);
  out.psi_rad = static_cast<double>(m.psi);
  out.psi_dot_rad_s = static_cast<double>(m.psi_dot);
  out.psi_ddot_rad_s2 = static_cast<double>(m.psi_dot_dot);
  return out;
}

inline void fill(const autonomy::multirotor::Trajectory& in,
                 roscopter_msgs::msg::TrajectoryCommand& m) {
  m.position = array(in.p_W);
  m.velocity = array(in.v_W);
  m.acceleration = array(in.a_W);
  m.psi = static_cast<float>(in.psi_rad);
  m.psi_dot = static_cast<float>(in.psi_dot_rad_s);
  m.psi_dot_dot = static_cast<float>(in.psi_ddot_rad_s2);
}

inline autonomy::multirotor::ControllerCommand command_of(
    const roscopter_msgs::msg::ControllerCommand& m) {
  autonomy::multirotor::ControllerCommand out;
  out.mode = static_cast<autonomy::multirotor::ControlMode>(
      m.mode);  // StateMachine::command_good looks at it
  out.cmd = {static_cast<double>(m.cmd1), static_cast<double>(m.cmd2), static_cast<double>(m.cmd3),
             static_cast<double>(m.cmd4)};
  out.valid = m.cmd_valid;
  return out;
}

inline void fill(const autonomy::multirotor::ControllerCommand& in,
                 roscopter_msgs::msg::ControllerCommand& m) {
  m.mode = static_cast<std::uint8_t>(in.mode);
  m.cmd1 = static_cast<float>(in.cmd[0]);
  m.cmd2 = static_cast<float>(in.cmd[1]);
  m.cmd3 = static_cast<float>(in.cmd[2]);
  m.cmd4 = static_cast<float>(in.cmd[3]);
  m.cmd_valid = in.valid;
}

inline void fill(const autonomy::FirmwareCommand& in, rosflight_msgs::msg::Command& m) {
  m.mode = static_cast<std::uint8_t>(in.mode);
  m.ignore = in.ignore;
  m.u = in.u;
}

/// A local waypoint.
inline autonomy::multirotor::Waypoint waypoint_of(const roscopter_msgs::msg::Waypoint& m) {
  autonomy::multirotor::Waypoint out;
  out.type = m.type == roscopter_msgs::msg::Waypoint::TYPE_GOTO ? autonomy::WaypointType::kGoto
                                                                : autonomy::WaypointType::kHold;
  out.p_W = vector(m.w);
  out.psi_rad = static_cast<double>(m.psi);
  if (m.speed > 0.0F) out.speed_m_s = static_cast<double>(m.speed);
  out.hold_s = static_cast<double>(m.hold_seconds);
  out.hold_indefinitely = m.hold_indefinitely;
  return out;
}

inline roscopter_msgs::msg::Waypoint message_of(const autonomy::multirotor::Waypoint& in) {
  roscopter_msgs::msg::Waypoint m;
  m.type = static_cast<std::uint8_t>(in.type);
  m.w = array(in.p_W);
  m.psi = static_cast<float>(in.psi_rad);
  m.speed = std::isfinite(in.speed_m_s) ? static_cast<float>(in.speed_m_s) : 0.0F;
  m.hold_seconds = static_cast<float>(in.hold_s);
  m.hold_indefinitely = in.hold_indefinitely;
  return m;
}

}  // namespace roscopter
