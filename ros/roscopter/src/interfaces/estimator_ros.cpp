// SPDX-License-Identifier: BSD-3-Clause
#include "ekf/estimator_ros.hpp"

namespace roscopter {

EstimatorROS::EstimatorROS(const rclcpp::NodeOptions& options) : StateEstimator(options) {}

}  // namespace roscopter
