// SPDX-License-Identifier: BSD-3-Clause
#include <roscopter_msgs/msg/state.hpp>
#include <rosflight_msgs/msg/attitude.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"

namespace roscopter {
namespace {

using roscopter_msgs::msg::State;
using rosflight_msgs::msg::Attitude;

/// Passes the estimated attitude on to the flight controller, whose own filter takes drag and turns
/// for tilt.
class ExtAttTranscriber : public rclcpp::Node {
 public:
  explicit ExtAttTranscriber(const rclcpp::NodeOptions& options)
      : Node("ext_att_transcriber", options) {
    attitudes_ = create_publisher<Attitude>("external_attitude", rclcpp::QoS(1));
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
                                         [this](State::ConstSharedPtr state) {
                                           Attitude out;
                                           out.header = state->header;
                                           out.attitude = state->quat;
                                           out.angular_velocity.x = static_cast<double>(state->p);
                                           out.angular_velocity.y = static_cast<double>(state->q);
                                           out.angular_velocity.z = static_cast<double>(state->r);
                                           attitudes_->publish(out);
                                         });
  }

 private:
  rclcpp::Publisher<Attitude>::SharedPtr attitudes_;
  rclcpp::Subscription<State>::SharedPtr states_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::ExtAttTranscriber, SingleThreadedExecutor)
