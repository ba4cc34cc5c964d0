// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/common/state_estimate.hpp"
#include "sim/types.hpp"

namespace rosflight::flight {

/// The truth in the form of an estimate: what a perfect estimator would report.
inline autonomy::StateEstimate true_state(const sim::Truth& truth) {
  autonomy::StateEstimate out;
  out.t_s = sim::to_seconds(truth.time);
  out.p_W = truth.body.p_W;
  out.v_W = truth.body.q_WB * truth.body.v_B;
  out.q_WB = truth.body.q_WB;
  out.w_B = truth.body.w_B;
  out.a_B = truth.specific_force_B;
  out.wind_W = truth.air.wind_W;
  const sim::Vector3 air_B = truth.body.q_WB.conjugate() * (out.v_W - out.wind_W);
  out.airspeed_m_s = air_B.norm();
  constexpr double kStill_m_s = 0.5;
  const bool moves = out.airspeed_m_s > kStill_m_s;
  out.alpha_rad = moves ? std::atan2(air_B.z(), air_B.x()) : 0.0;
  out.beta_rad = moves ? std::asin(std::clamp(air_B.y() / out.airspeed_m_s, -1.0, 1.0)) : 0.0;
  const bool over_ground = out.v_W.head<2>().norm() > kStill_m_s;
  const sim::Vector3 nose = out.q_WB * sim::Vector3::UnitX();
  const sim::Vector3& along = over_ground ? out.v_W : nose;
  out.course_rad = std::atan2(along.y(), along.x());
  out.attitude = out.heading = out.horizontal = out.vertical = autonomy::Quality::kGood;
  out.wind_valid = out.air_valid = true;
  return out;
}

}  // namespace rosflight::flight
