// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/holoocean/frames.hpp"

#include <algorithm>
#include <cmath>

#include "base/constants.hpp"

namespace rosflight::viewer::holoocean {
namespace {

using sim::Matrix3;
using sim::Quaternion;
using sim::Vector3;

/// M: front-right-down or north-east-down to forward-left-up, and back.
Vector3 mirrored(const Vector3& v) {
  return {v.x(), -v.y(), -v.z()};
}

std::array<float, 3> floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

Vector3 vector(const std::array<float, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// Roll, pitch, yaw with R = Rz Ry Rx [rad]. At a pitch of 90 degrees, where only a combination of roll and yaw is
/// defined, both are still those of one rotation that is R.
Vector3 roll_pitch_yaw(const Matrix3& R) {
  constexpr double kNearVertical = 1.0 - 1e-12;
  const double sine = std::clamp(-R(2, 0), -1.0, 1.0);
  if (std::abs(sine) > kNearVertical) {
    return {0.0, std::copysign(0.5 * base::kPi, sine), std::atan2(-R(0, 1), R(1, 1))};
  }
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(sine), std::atan2(R(1, 0), R(0, 0))};
}

Quaternion rotation(const Vector3& angle) {
  const double norm = angle.norm();
  if (!(norm > 0.0)) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(norm, angle / norm));
}

}  // namespace

AgentState agent_state(const sim::BodyState& body, const std::array<double, 3>& origin_m,
                       double step_s) {
  const Vector3 v_W = body.q_WB * body.v_B;
  const Vector3 p_W = body.p_W - v_W * step_s;
  const Quaternion q_WB = body.q_WB * rotation(-body.w_B * step_s);
  const Quaternion q_E{q_WB.w(), q_WB.x(), -q_WB.y(), -q_WB.z()};
  const Vector3 origin{origin_m[0], origin_m[1], origin_m[2]};
  AgentState state;
  state.position_m = floats(origin + mirrored(p_W));
  state.roll_pitch_yaw_deg = floats(roll_pitch_yaw(q_E.toRotationMatrix()) * base::kDegPerRad);
  state.velocity_m_s = floats(mirrored(v_W));
  state.rate_deg_s = floats(mirrored(body.w_B) * base::kDegPerRad);
  return state;
}

Vector3 position_W(const std::array<float, 3>& position_m, const std::array<double, 3>& origin_m) {
  return mirrored(vector(position_m) - Vector3{origin_m[0], origin_m[1], origin_m[2]});
}

Quaternion attitude_WB(const std::array<float, 3>& roll_pitch_yaw_deg) {
  const Vector3 angles = vector(roll_pitch_yaw_deg) * base::kRadPerDeg;
  const Quaternion q_E = Eigen::AngleAxisd(angles.z(), Vector3::UnitZ()) *
                         Eigen::AngleAxisd(angles.y(), Vector3::UnitY()) *
                         Eigen::AngleAxisd(angles.x(), Vector3::UnitX());
  return {q_E.w(), q_E.x(), -q_E.y(), -q_E.z()};
}

Vector3 velocity_W(const std::array<float, 3>& velocity_m_s) {
  return mirrored(vector(velocity_m_s));
}

}  // namespace rosflight::viewer::holoocean
