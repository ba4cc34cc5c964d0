// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/state_estimate.hpp"
#include "sim/types.hpp"

namespace rosflight::python {

/// What observations and the companion's loops are made from.
struct SeenState {
  sim::Vector3 p_W{sim::Vector3::Zero()};
  sim::Vector3 v_W{sim::Vector3::Zero()};
  sim::Quaternion q_WB{sim::Quaternion::Identity()};
  sim::Vector3 w_B{sim::Vector3::Zero()};
  sim::Vector3 wind_W{sim::Vector3::Zero()};

  /// The truth, as a perfect estimator would report it.
  static SeenState of(const sim::Truth& truth) {
    const sim::BodyState& body = truth.body;
    return {body.p_W, body.q_WB * body.v_B, body.q_WB, body.w_B, truth.air.wind_W};
  }
  static SeenState of(const autonomy::StateEstimate& estimate) {
    return {estimate.p_W, estimate.v_W, estimate.q_WB, estimate.w_B, estimate.wind_W};
  }
};

}  // namespace rosflight::python
