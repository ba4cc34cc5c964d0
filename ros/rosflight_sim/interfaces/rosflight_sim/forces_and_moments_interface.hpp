// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/pwm_output.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <std_msgs/msg/bool.hpp>

#include "rosflight_common/firmware_parameters.hpp"

namespace rosflight_sim {

/// Base class for forces and moments of your own: node `mav_forces_and_moments`, in place of ours (launch argument forces:=false).
/// The names are those of ROSflight 2.x.
///
/// For each message on `sim/pwm_output` it calls update_forces_and_torques with the newest truth and wind and publishes the wrench
/// under the stamp of the pulses. It reads the mixer of the firmware in the background, at the start and after each change of a
/// parameter, and then calls get_firmware_parameters. Compiles as C++17.
class ForcesAndMomentsInterface : public rclcpp::Node {
 public:
  explicit ForcesAndMomentsInterface(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());

 protected:
  // NOLINTBEGIN(readability-identifier-naming): names of ROSflight 2.x
  static constexpr std::uint8_t NUM_TOTAL_OUTPUTS = 14;
  static constexpr std::uint8_t NUM_MIXER_OUTPUTS = 10;
  // NOLINTEND(readability-identifier-naming)
  using MixingMatrix = Eigen::Matrix<double, NUM_MIXER_OUTPUTS, NUM_MIXER_OUTPUTS>;

 public:
  /// @param x         the newest truth: position in NED [m], attitude body to NED, velocity and rates in body axes.
  /// @param wind      in NED [m/s].
  /// @param act_cmds  pulses of all outputs [us].
  /// @returns force and torque about the centre of mass in body axes [N, N m], gravity not included.
  virtual geometry_msgs::msg::WrenchStamped update_forces_and_torques(
      rosflight_msgs::msg::SimState x, geometry_msgs::msg::Vector3Stamped wind,
      std::array<std::uint16_t, NUM_TOTAL_OUTPUTS> act_cmds) = 0;

  /// Called when the mixer members below have the values of the firmware, and again after each change of a firmware parameter.
  virtual void get_firmware_parameters() {}

 protected:
  /// x between min and max, in whichever order they are given.
  static double sat(double x, double max, double min);
  static double max(double x, double y) { return x > y ? x : y; }

  /// PRI_MIXER_i_j and SEC_MIXER_i_j. Of the custom mixer (11) the transposed pseudo-inverse, unless the parameter
  /// invert_mixing_matrix is false. Zero until they are read.
  MixingMatrix primary_mixing_matrix_{MixingMatrix::Zero()};
  MixingMatrix secondary_mixing_matrix_{MixingMatrix::Zero()};
  /// PRI_MIXER_OUT_i: what each output drives.
  Eigen::Matrix<int, 1, NUM_MIXER_OUTPUTS> mixer_header_vals_{
      Eigen::Matrix<int, 1, NUM_MIXER_OUTPUTS>::Zero()};
  int primary_mixer_{255};  ///< PRIMARY_MIXER; 255: not read yet.
  int secondary_mixer_{255};

 private:
  void store(const rosflight_common::FirmwareParameters::Values& values);

  rosflight_msgs::msg::SimState state_;
  geometry_msgs::msg::Vector3Stamped air_;
  bool invert_;
  rclcpp::Publisher<geometry_msgs::msg::WrenchStamped>::SharedPtr wrench_;
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr wind_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::Subscription<rosflight_msgs::msg::PwmOutput>::SharedPtr pulses_;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr changes_;
  rosflight_common::FirmwareParameters mixer_;
};

}  // namespace rosflight_sim
