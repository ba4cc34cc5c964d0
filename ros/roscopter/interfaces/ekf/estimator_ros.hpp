// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <roscopter_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/estimator_interface.hpp"

namespace roscopter {

/// Base class for an estimator of your own: node `estimator`, in place of roscopter's (launch argument estimator:=false). The
/// names are those of roscopter 2.0. Write estimate(); what it gets, and when it is called: rosflight_common/estimator_interface.hpp.
class EstimatorROS : public rosflight_common::StateEstimator<roscopter_msgs::msg::State,
                                                             rosflight_common::EstimatorOutput> {
 public:
  explicit EstimatorROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());
};

}  // namespace roscopter
