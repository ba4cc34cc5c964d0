// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/forces_and_moments_interface.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <memory>
#include <utility>

#include "rosflight_common/node_tools.hpp"

namespace rosflight_sim {

using rosflight_common::newest;

namespace {

constexpr std::size_t kMixers = 2, kSize = 10;
constexpr std::size_t kHeaders = kMixers + kSize;
constexpr std::size_t kNames = kHeaders + kMixers * kSize * kSize;
constexpr auto kBetween = std::chrono::milliseconds(2);
constexpr auto kNoAnswer = std::chrono::seconds(1);
constexpr int kCustomMixer = 11;

}  // namespace

ForcesAndMomentsInterface::ForcesAndMomentsInterface(const rclcpp::NodeOptions& options)
    : Node("mav_forces_and_moments", options),
      invert_{rosflight_common::declare_switch(*this, "invert_mixing_matrix", true,
                                               "of the custom mixer")} {
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
        if (!message->data) return;
        next_ = 0;
        asking_ = true;
      });
  get_ = create_client<ParamGet>("param_get");
  timer_ = create_wall_timer(kBetween, [this] { ask(); });
}

double ForcesAndMomentsInterface::sat(double x, double max, double min) {
  return std::clamp(x, std::min(min, max), std::max(min, max));
}

/// The name that comes next: both mixers, the kinds of outputs, then the entries of both, row by row.
std::string ForcesAndMomentsInterface::wanted() const {
  if (next_ < kMixers) return next_ == 0 ? "PRIMARY_MIXER" : "SECONDARY_MIXER";
  if (next_ < kHeaders) return "PRI_MIXER_OUT_" + std::to_string(next_ - kMixers);
  const std::size_t entry = (next_ - kHeaders) / kMixers;
  return std::string((next_ - kHeaders) % kMixers == 0 ? "PRI" : "SEC") + "_MIXER_" +
         std::to_string(entry / kSize) + "_" + std::to_string(entry % kSize);
}

/// One question at a time. What rosflight_io has not received yet is asked for again.
void ForcesAndMomentsInterface::ask() {
  const auto now = Wall::now();
  if (!asking_ || (asked_ && now - *asked_ < kNoAnswer)) return;
  if (asked_) get_->prune_pending_requests();
  asked_.reset();
  if (!get_->service_is_ready()) return;
  auto request = std::make_shared<ParamGet::Request>();
  request->name = wanted();
  asked_ = now;
  get_->async_send_request(std::move(request),
                           [this, name = wanted()](rclcpp::Client<ParamGet>::SharedFuture answer) {
                             asked_.reset();
                             if (answer.get()->exists && name == wanted())
                               take(answer.get()->value);
                           });
}

void ForcesAndMomentsInterface::take(double value) {
  if (next_ < kMixers) {
    (next_ == 0 ? primary_mixer_ : secondary_mixer_) = static_cast<int>(value);
  } else if (next_ < kHeaders) {
    mixer_header_vals_(static_cast<Eigen::Index>(next_ - kMixers)) = static_cast<int>(value);
  } else {
    const std::size_t entry = (next_ - kHeaders) / kMixers;
    MixingMatrix& matrix =
        (next_ - kHeaders) % kMixers == 0 ? primary_mixing_matrix_ : secondary_mixing_matrix_;
    matrix(static_cast<Eigen::Index>(entry / kSize), static_cast<Eigen::Index>(entry % kSize)) =
        value;
  }
  if (++next_ == kNames) all_known();
}

void ForcesAndMomentsInterface::all_known() {
  asking_ = false;
  next_ = 0;
  if (primary_mixer_ == kCustomMixer && invert_) {
    for (MixingMatrix* matrix : {&primary_mixing_matrix_, &secondary_mixing_matrix_})
      *matrix = MixingMatrix(matrix->completeOrthogonalDecomposition().pseudoInverse().transpose());
  }
  get_firmware_parameters();
}

}  // namespace rosflight_sim
