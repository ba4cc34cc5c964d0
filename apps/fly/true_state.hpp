// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cmath>

#include "autonomy/common/state_estimate.hpp"
#include "sim/types.hpp"

namespace rosflight::apps {

/// The truth in the form of an estimate: what a perfect estimator would say.
inline autonomy::StateEstimate true_state(const sim::Truth& truth) {
  autonomy::StateEstimate out;
  out.t_s = static_cast<double>(truth.time.count()) * 1e-6;
  out.p_N = truth.body.p_N;
  out.v_N = truth.body.q_NB * truth.body.v_B;
  out.q_NB = truth.body.q_NB;
  out.w_B = truth.body.w_B;
  out.a_B = truth.specific_force_B;
  out.wind_N = truth.air.wind_N;
  const sim::Vector3 air_B = truth.body.q_NB.conjugate() * (out.v_N - out.wind_N);
  out.airspeed_m_s = air_B.norm();
  constexpr double kStill_m_s = 0.5;
  const bool moves = out.airspeed_m_s > kStill_m_s;
  out.alpha_rad = moves ? std::atan2(air_B.z(), air_B.x()) : 0.0;
  out.beta_rad = moves ? std::asin(std::clamp(air_B.y() / out.airspeed_m_s, -1.0, 1.0)) : 0.0;
  const bool over_ground = std::hypot(out.v_N.x(), out.v_N.y()) > kStill_m_s;
  const sim::Vector3 nose = out.q_NB * sim::Vector3::UnitX();
  const sim::Vector3& along = over_ground ? out.v_N : nose;
  out.course_rad = std::atan2(along.y(), along.x());
  out.attitude = out.heading = out.horizontal = out.vertical = autonomy::Trust::kGood;
  out.wind_valid = out.air_valid = true;
  return out;
}

}  // namespace rosflight::apps
