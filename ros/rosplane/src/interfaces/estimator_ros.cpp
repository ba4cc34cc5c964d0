// SPDX-License-Identifier: BSD-3-Clause
#include "ekf/estimator_ros.hpp"

#include <algorithm>
#include <cmath>

#include "base/atmosphere.hpp"

namespace rosplane {

EstimatorROS::EstimatorROS(const rclcpp::NodeOptions& options) : EstimatorInterface(options) {
  params_.declare_double("airspeed_measurement_gate", 5.0);
  params_.declare_int("max_diff_sensor_silence_duration_ms", 110);
  using rosflight_msgs::msg::Airspeed;
  airspeeds_ = create_subscription<Airspeed>(
      "airspeed", rclcpp::QoS(10), [this](Airspeed::ConstSharedPtr message) { take(*message); });
}

void EstimatorROS::take(const rosflight_msgs::msg::Airspeed& message) {
  heard("diff");
  const auto speed_m_s = static_cast<float>(params_.get_double("airspeed_measurement_gate"));
  const float gate_Pa = 0.5F * rho_ * speed_m_s * speed_m_s;
  float& pressure = input().diff_pres;
  pressure = std::clamp(message.differential_pressure, pressure - gate_Pa, pressure + gate_Pa);
  input().diff_new = true;
}

void EstimatorROS::fill(const Output& output, rosplane_msgs::msg::State& message) const {
  message.p_n = output.pn, message.p_e = output.pe, message.p_d = output.pd;
  message.v_x = output.vx, message.v_y = output.vy, message.v_z = output.vz;
  message.phi = output.phi, message.theta = output.theta, message.psi = output.psi;
  message.p = output.p, message.q = output.q, message.r = output.r;
  message.b_x = output.bx, message.b_y = output.by, message.b_z = output.bz;
  message.va = output.va, message.alpha = output.alpha, message.beta = output.beta;
  message.chi = output.chi, message.w_n = output.wn, message.w_e = output.we;
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

}  // namespace rosplane
