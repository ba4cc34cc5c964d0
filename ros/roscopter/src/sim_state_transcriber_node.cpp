// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <rosflight_msgs/msg/sim_state.hpp>

#include "roscopter/conversions.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/while_read.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace {

using roscopter_msgs::msg::State;
using rosflight_msgs::msg::SimState;

/// The simulator's truth as a State: biases and origin are zero. For comparing, and for tuning
/// without an estimator; stamps are those of the truth, so no clock is needed.
class SimStateTranscriber : public rclcpp::Node {
 public:
  explicit SimStateTranscriber(const rclcpp::NodeOptions& options)
      : Node("roscopter_truth", options) {
    states_ = create_publisher<State>("sim/roscopter/state", rclcpp::QoS(1));
    truth_.emplace(*this, rosflight_common::WhileRead::Made{states_},
                   [this]() -> rosflight_common::WhileRead::Subscriptions {
                     return {create_subscription<SimState>(
                         "sim/truth_state", rosflight_common::stream(),
                         [this](SimState::ConstSharedPtr truth) { pass(*truth); })};
                   });
  }

 private:
  void pass(const SimState& truth) {
    const auto& p = truth.pose.position;
    const auto& q = truth.pose.orientation;
    const auto& v = truth.twist.linear;
    const auto& w = truth.twist.angular;
    autonomy::StateEstimate state;
    state.p_W = {p.x, p.y, p.z};
    state.q_WB = autonomy::Quaternion{q.w, q.x, q.y, q.z};
    state.v_W = state.q_WB * autonomy::Vector3{v.x, v.y, v.z};
    state.w_B = {w.x, w.y, w.z};
    State out;
    fill(state, {}, out);
    out.header = truth.header;
    states_->publish(out);
  }

  rclcpp::Publisher<State>::SharedPtr states_;
  std::optional<rosflight_common::WhileRead> truth_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::SimStateTranscriber, SingleThreadedExecutor)
