// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosplane_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/estimator_interface.hpp"

namespace rosplane {

struct EstimatorOutput : rosflight_common::EstimatorOutput {
  float h{};              ///< Altitude above the origin [m]; not published.
  float va{};             ///< Airspeed [m/s].
  float alpha{}, beta{};  ///< Angles of attack and sideslip [rad].
  float chi{};            ///< Course [rad].
  float vg{};             ///< Ground speed [m/s]; not published.
  float wn{}, we{};       ///< Wind to the north and to the east [m/s].
};

/// Base class for an estimator of your own: node `estimator`, in place of rosplane's (launch argument estimator:=false). The
/// names are those of rosplane 2.0. Write estimate(); what it gets, and when it is called: rosflight_common/estimator_interface.hpp.
/// It also gets `airspeed`, whose pressure changes by at most that of airspeed_measurement_gate [m/s] per sample.
class EstimatorROS
    : public rosflight_common::StateEstimator<rosplane_msgs::msg::State, EstimatorOutput> {
 public:
  explicit EstimatorROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 private:
  void fill_more(const Output& output, rosplane_msgs::msg::State& message) const override;
  void take(const rosflight_msgs::msg::Airspeed& message);

  rclcpp::Subscription<rosflight_msgs::msg::Airspeed>::SharedPtr airspeeds_;
};

}  // namespace rosplane
