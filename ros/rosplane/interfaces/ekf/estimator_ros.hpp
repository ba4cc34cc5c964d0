// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosplane_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/estimator_interface.hpp"

namespace rosplane {

/// What a filter of yours returns: place in NED [m], velocity and rates in body axes [m/s, rad/s], height and ground speed (not sent), airspeed
/// [m/s], angles [rad], gyro bias [rad/s], course [rad], wind in NED [m/s], attitude body to NED.
struct EstimatorOutput {
  float pn{}, pe{}, pd{};
  float vx{}, vy{}, vz{};
  float h{}, va{}, alpha{}, beta{};
  float phi{}, theta{}, psi{};
  float bx{}, by{}, bz{};
  float chi{};
  float p{}, q{}, r{};
  float vg{}, wn{}, we{};
  Eigen::Quaternionf quat{1.0F, 0.0F, 0.0F, 0.0F};
};

/// An estimator of your own: node `estimator`, in place of rosplane's (launch argument estimator:=false). Names are those of rosplane 2.0:
/// derive and write estimate(). What arrives, and when it is called: rosflight_common/estimator_interface.hpp, and `airspeed` besides, whose
/// pressure changes by at most that of airspeed_measurement_gate [m/s] from sample to sample.
class EstimatorROS
    : public rosflight_common::EstimatorInterface<rosplane_msgs::msg::State, EstimatorOutput> {
 public:
  explicit EstimatorROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  using Output = EstimatorOutput;

 private:
  void fill(const Output& output, rosplane_msgs::msg::State& message) const override;
  float standard_density(float altitude_m) const override;
  void take(const rosflight_msgs::msg::Airspeed& message);

  rclcpp::Subscription<rosflight_msgs::msg::Airspeed>::SharedPtr airspeeds_;
};

}  // namespace rosplane
