// SPDX-License-Identifier: BSD-3-Clause
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <optional>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <sensor_msgs/msg/imu.hpp>

#include "rosflight_common/component.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/vehicle_file.hpp"
#include "rosflight_common/while_read.hpp"
#include "rosplane/conversions.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using geometry_msgs::msg::Vector3Stamped;
using rosflight_msgs::msg::SimState;
using rosplane_msgs::msg::State;
using sensor_msgs::msg::Imu;

/// The simulator's truth as a State, with the origin of the vehicle file. For comparing, and for
/// tuning without an estimator; stamps are those of the truth, so no clock is needed.
class SimStateTranscriber : public rclcpp::Node {
 public:
  explicit SimStateTranscriber(const rclcpp::NodeOptions& options)
      : Node("rosplane_truth", options) {
    origin_ =
        rosflight_common::VehicleFile::declare(*this, kUsualVehicle).read().environment().origin;
    states_ = create_publisher<State>("sim/rosplane/state", rclcpp::QoS(1));
    truth_.emplace(*this, rosflight_common::WhileRead::Made{states_},
                   [this] { return subscribe(); });
  }

 private:
  rosflight_common::WhileRead::Subscriptions subscribe() {
    return {
        create_subscription<Vector3Stamped>("sim/truth_wind", rosflight_common::stream(),
                                            [this](Vector3Stamped::ConstSharedPtr m) {
                                              state_.wind_W = {m->vector.x, m->vector.y,
                                                               m->vector.z};
                                            }),
        create_subscription<Imu>("sim/truth_imu_bias", rosflight_common::stream(),
                                 [this](Imu::ConstSharedPtr m) {
                                   const auto& b = m->angular_velocity;
                                   state_.gyro_bias_B = {b.x, b.y, b.z};
                                 }),
        create_subscription<SimState>("sim/truth_state", rosflight_common::stream(),
                                      [this](SimState::ConstSharedPtr truth) { pass(*truth); })};
  }

  void pass(const SimState& truth) {
    const auto& p = truth.pose.position;
    const auto& q = truth.pose.orientation;
    const auto& v = truth.twist.linear;
    const auto& w = truth.twist.angular;
    state_.p_W = {p.x, p.y, p.z};
    state_.q_WB = autonomy::Quaternion{q.w, q.x, q.y, q.z};
    const autonomy::Vector3 v_B{v.x, v.y, v.z};
    state_.v_W = state_.q_WB * v_B;
    state_.w_B = {w.x, w.y, w.z};
    const autonomy::Vector3 air_B = v_B - state_.q_WB.conjugate() * state_.wind_W;
    state_.airspeed_m_s = air_B.norm();
    constexpr double kMoves_m_s = 0.5;
    const bool moves = state_.airspeed_m_s > kMoves_m_s;
    state_.alpha_rad = moves ? std::atan2(air_B.z(), air_B.x()) : 0.0;
    state_.beta_rad = moves ? std::asin(air_B.y() / state_.airspeed_m_s) : 0.0;
    state_.course_rad = state_.v_W.head<2>().norm() > kMoves_m_s
                            ? std::atan2(state_.v_W.y(), state_.v_W.x())
                            : autonomy::heading_of(state_.q_WB);
    state_.wind_valid = true;
    using autonomy::Quality;
    state_.attitude = state_.heading = state_.horizontal = state_.vertical = Quality::kGood;
    State out;
    put(state_, origin_, out);
    out.header = truth.header;
    states_->publish(out);
  }

  autonomy::Geodetic origin_{};
  autonomy::StateEstimate state_{};
  rclcpp::Publisher<State>::SharedPtr states_;
  std::optional<rosflight_common::WhileRead> truth_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::SimStateTranscriber, SingleThreadedExecutor)
