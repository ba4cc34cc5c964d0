// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <roscopter_msgs/msg/state.hpp>

#include "param_manager/param_manager.hpp"
#include "rosflight_common/estimator_interface.hpp"

namespace roscopter {

/// What a filter of yours returns: place in NED [m], velocity and rates in body axes [m/s, rad/s], angles [rad], gyro bias [rad/s],
/// attitude body to NED.
struct EstimatorOutput {
  float pn{}, pe{}, pd{};
  float vx{}, vy{}, vz{};
  float phi{}, theta{}, psi{};
  float bx{}, by{}, bz{};
  float p{}, q{}, r{};
  Eigen::Quaternionf quat{1.0F, 0.0F, 0.0F, 0.0F};
};

/// An estimator of your own: node `estimator`, in place of roscopter's (launch argument estimator:=false). Names are those of roscopter
/// 2.0: derive and write estimate(). What arrives, and when it is called: rosflight_common/estimator_interface.hpp.
class EstimatorROS
    : public rosflight_common::EstimatorInterface<roscopter_msgs::msg::State, EstimatorOutput> {
 public:
  explicit EstimatorROS(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  using Output = EstimatorOutput;

 private:
  void fill(const Output& output, roscopter_msgs::msg::State& message) const override;
  float standard_density(float altitude_m) const override;
};

}  // namespace roscopter
