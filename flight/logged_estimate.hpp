// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "autonomy/common/state_estimate.hpp"
#include "autonomy/estimation/health.hpp"
#include "messages/rosflight_log_msgs.hpp"

namespace rosflight::flight {

using LoggedEstimate = messages::rosflight_log_msgs::Estimate;

/// The estimate as the log has it.
LoggedEstimate logged(const autonomy::StateEstimate& estimate,
                      const autonomy::estimation::EstimatorHealth& health);

}  // namespace rosflight::flight
