// SPDX-License-Identifier: BSD-3-Clause
#include "ekf/estimator_ros.hpp"

#include <algorithm>
#include <cmath>

#include "rosflight_common/node_tools.hpp"

namespace rosplane {

EstimatorROS::EstimatorROS(const rclcpp::NodeOptions& options) : StateEstimator(options) {
  params_.declare_double("airspeed_measurement_gate", 5.0);
  params_.declare_int("max_diff_sensor_silence_duration_ms", 110);
  received("diff");
  using rosflight_msgs::msg::Airspeed;
  airspeeds_ =
      create_subscription<Airspeed>("airspeed", rosflight_common::stream(10),
                                    [this](Airspeed::ConstSharedPtr message) { take(*message); });
}

void EstimatorROS::take(const rosflight_msgs::msg::Airspeed& message) {
  received("diff");
  if (!std::isfinite(message.differential_pressure)) return;
  const auto speed_m_s = static_cast<float>(params_.get_double("airspeed_measurement_gate"));
  const float gate_Pa = 0.5F * rho_ * speed_m_s * speed_m_s;
  float& pressure = input().diff_pres;
  pressure = std::clamp(message.differential_pressure, pressure - gate_Pa, pressure + gate_Pa);
  input().diff_new = true;
}

void EstimatorROS::fill_more(const Output& output, rosplane_msgs::msg::State& message) const {
  message.va = output.va, message.alpha = output.alpha, message.beta = output.beta;
  message.chi = output.chi, message.w_n = output.wn, message.w_e = output.we;
}

}  // namespace rosplane
