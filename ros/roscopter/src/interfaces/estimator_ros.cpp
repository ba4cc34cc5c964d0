// SPDX-License-Identifier: BSD-3-Clause
#include "ekf/estimator_ros.hpp"

#include <cmath>

#include "base/atmosphere.hpp"

namespace roscopter {

EstimatorROS::EstimatorROS(const rclcpp::NodeOptions& options) : EstimatorInterface(options) {}

void EstimatorROS::fill(const Output& output, roscopter_msgs::msg::State& message) const {
  message.p_n = output.pn, message.p_e = output.pe, message.p_d = output.pd;
  message.v_x = output.vx, message.v_y = output.vy, message.v_z = output.vz;
  message.phi = output.phi, message.theta = output.theta, message.psi = output.psi;
  message.p = output.p, message.q = output.q, message.r = output.r;
  message.b_x = output.bx, message.b_y = output.by, message.b_z = output.bz;
  const Eigen::Quaterniond quat = output.quat.cast<double>();
  message.quat.w = quat.w(), message.quat.x = quat.x();
  message.quat.y = quat.y(), message.quat.z = quat.z();
}

float EstimatorROS::standard_density(float altitude_m) const {
  namespace base = rosflight::base;
  const auto& air = base::kRosflightTroposphere;
  const double share = 1.0 - static_cast<double>(altitude_m) / air.scale_m;
  return static_cast<float>(base::kSeaLevelDensity_kg_m3 *
                            std::pow(share, air.pressure_exponent * air.density_exponent));
}

}  // namespace roscopter
