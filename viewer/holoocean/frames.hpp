// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>

#include "sim/types.hpp"

/// Conversions between our frames (W north-east-down, B front-right-down) and those of the engine's client: E is
/// x forward, y left, z up in the level, attitude is roll, pitch, yaw in degrees about fixed axes, R = Rz Ry Rx.
/// With M = diag(1, -1, -1):
///
///     p_E = p_E_origin + M p_W          (1)
///     R_E = M R_WB M                    (2)  (roll, -pitch, -yaw) of the aircraft
///     v_E = M R_WB v_B                  (3)  world axes
///     w_A = M w_B                       (4)  axes of the agent, in degrees per second
namespace rosflight::viewer::holoocean {

/// The twelve numbers of the engine's teleport command, in its order.
struct AgentState {
  std::array<float, 3> position_m{};
  std::array<float, 3> roll_pitch_yaw_deg{};
  std::array<float, 3> velocity_m_s{};  ///< World axes.
  std::array<float, 3> rate_deg_s{};    ///< Body axes.
};
static_assert(sizeof(AgentState) == 48);

/// The state to send so that the engine's sensors measure `body`.
///
/// The engine moves the agent by one physics step of the velocity that was sent, then measures. So the state is
/// taken back by that step:
///
///     p = p_W - v_W h,   q = q_WB exp(-w_B h)     (5)
///
/// @param origin_m  position of W's origin in the level.
/// @param step_s  h, length of a physics step of the engine; 0: the state as it is.
AgentState agent_state(const sim::BodyState& body, const std::array<double, 3>& origin_m,
                       double step_s);

/// Inverses of (1) to (3), for what the engine's sensors report.
sim::Vector3 position_W(const std::array<float, 3>& position_m,
                        const std::array<double, 3>& origin_m);
sim::Quaternion attitude_WB(const std::array<float, 3>& roll_pitch_yaw_deg);
sim::Vector3 velocity_W(const std::array<float, 3>& velocity_m_s);

}  // namespace rosflight::viewer::holoocean
