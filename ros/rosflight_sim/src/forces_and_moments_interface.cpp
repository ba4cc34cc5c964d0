// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/forces_and_moments_interface.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_sim {

using rosflight_common::FirmwareParameters;
using rosflight_common::newest;

namespace {

constexpr int kSize = 10;
constexpr int kCustomMixer = 11;

std::string output_name(int k) {
  return "PRI_MIXER_OUT_" + std::to_string(k);
}

std::string entry_name(const char* mixer, int row, int column) {
  return std::string(mixer) + "_MIXER_" + std::to_string(row) + "_" + std::to_string(column);
}

std::vector<std::string> mixer_names() {
  std::vector<std::string> names{"PRIMARY_MIXER", "SECONDARY_MIXER"};
  for (int k = 0; k < kSize; ++k) names.push_back(output_name(k));
  for (const char* mixer : {"PRI", "SEC"}) {
    for (int k = 0; k < kSize * kSize; ++k)
      names.push_back(entry_name(mixer, k / kSize, k % kSize));
  }
  return names;
}

}  // namespace

ForcesAndMomentsInterface::ForcesAndMomentsInterface(const rclcpp::NodeOptions& options)
    : Node("mav_forces_and_moments", options),
      invert_{rosflight_common::declare_switch(*this, "invert_mixing_matrix", true,
                                               "inverts the matrix of the custom mixer")},
      mixer_{*this, mixer_names(), std::chrono::milliseconds(2),
             FirmwareParameters::Repeat::kOnRequest,
             [this](const FirmwareParameters::Values& values) { store(values); }} {
  wrench_ = create_publisher<geometry_msgs::msg::WrenchStamped>("sim/forces_and_moments", newest());
  truth_ = create_subscription<rosflight_msgs::msg::SimState>(
      "sim/truth_state", newest(),
      [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) { state_ = *message; });
  wind_ = create_subscription<geometry_msgs::msg::Vector3Stamped>(
      "sim/truth_wind", newest(),
      [this](geometry_msgs::msg::Vector3Stamped::ConstSharedPtr message) { air_ = *message; });
  pulses_ = create_subscription<rosflight_msgs::msg::PwmOutput>(
      "sim/pwm_output", newest(), [this](rosflight_msgs::msg::PwmOutput::ConstSharedPtr message) {
        auto wrench = update_forces_and_torques(state_, air_, message->values);
        wrench.header.stamp = message->header.stamp;
        wrench.header.frame_id = "aircraft_body";
        wrench_->publish(wrench);
      });
  changes_ = create_subscription<std_msgs::msg::Bool>(
      "status/params_changed", newest(), [this](std_msgs::msg::Bool::ConstSharedPtr message) {
        if (message->data) mixer_.read_again();
      });
}

double ForcesAndMomentsInterface::sat(double x, double max, double min) {
  return std::clamp(x, std::min(min, max), std::max(min, max));
}

void ForcesAndMomentsInterface::store(const FirmwareParameters::Values& values) {
  primary_mixer_ = static_cast<int>(values.at("PRIMARY_MIXER"));
  secondary_mixer_ = static_cast<int>(values.at("SECONDARY_MIXER"));
  for (int row = 0; row < kSize; ++row) {
    mixer_header_vals_(row) = static_cast<int>(values.at(output_name(row)));
    for (int column = 0; column < kSize; ++column) {
      primary_mixing_matrix_(row, column) = values.at(entry_name("PRI", row, column));
      secondary_mixing_matrix_(row, column) = values.at(entry_name("SEC", row, column));
    }
  }
  if (primary_mixer_ == kCustomMixer && invert_) {
    for (MixingMatrix* matrix : {&primary_mixing_matrix_, &secondary_mixing_matrix_})
      *matrix = MixingMatrix(matrix->completeOrthogonalDecomposition().pseudoInverse().transpose());
  }
  get_firmware_parameters();
}

}  // namespace rosflight_sim
