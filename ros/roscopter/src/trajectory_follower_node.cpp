// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <std_srvs/srv/trigger.hpp>

#include "autonomy/multirotor/trajectory_follower.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "ros/common/live_parameters.hpp"
#include "ros/common/time.hpp"
#include "ros/common/vehicle_file.hpp"
#include "ros/roscopter/src/conversions.hpp"
#include "ros/roscopter/src/flight_phase.hpp"

namespace rosflight::roscopter {
namespace {

using autonomy::multirotor::FollowerConfig;
using roscopter_msgs::msg::ControllerCommand;
using roscopter_msgs::msg::State;
using roscopter_msgs::msg::TrajectoryCommand;
using rosflight_msgs::msg::Status;
using std_srvs::srv::Trigger;

std::vector<ros_common::LiveParameter<FollowerConfig>> follower_parameters() {
  using C = FollowerConfig;
  std::vector<ros_common::LiveParameter<C>> list{
      {"gravity", 9.0, 10.0, "[m/s^2]", [](const C& c) { return c.gravity_m_s2; },
       [](C& c, double x) { c.gravity_m_s2 = x; }},
      {"mass", 0.01, 1000.0, "[kg]", [](const C& c) { return c.mass_kg; },
       [](C& c, double x) { c.mass_kg = x; }},
      {"down_command_window", 0.1, 100.0, "farther away an error counts as this much [m]",
       [](const C& c) { return c.max_position_error_m; },
       [](C& c, double x) { c.max_position_error_m = x; }},
      {"max_commanded_down_accel_in_gs", -0.95, -0.05,
       "least upward share of thrust, negative, in weights",
       [](const C& c) { return -c.min_lift_ratio; }, [](C& c, double x) { c.min_lift_ratio = -x; }},
      {"trajectory_timeout_s", 0.01, 60.0, "an older setpoint is not followed [s]",
       [](const C& c) { return c.timeout_s; }, [](C& c, double x) { c.timeout_s = x; }},
  };
  using ros_common::add_gains;
  const std::string position = "of the acceleration from the position error";
  add_gains(list, "u_n", position, 1.0, [](auto& c) -> auto& { return c.horizontal; });
  add_gains(list, "u_e", position, 1.0, [](auto& c) -> auto& { return *c.east; });
  add_gains(list, "u_d", position, 1.0, [](auto& c) -> auto& { return c.vertical; });
  add_gains(list, "yaw_to_rate", "of the yaw rate from the heading", 1.0,
            [](auto& c) -> auto& { return c.heading; });
  return list;
}

FollowerConfig with_east(FollowerConfig config) {
  if (!config.east) config.east = config.horizontal;
  return config;
}

/// Where a setpoint has got to, dt_s after its stamp.
autonomy::multirotor::Trajectory carried_on(autonomy::multirotor::Trajectory s, double dt_s) {
  s.p_W += dt_s * s.v_W + 0.5 * dt_s * dt_s * s.a_W;
  s.v_W += dt_s * s.a_W;
  s.psi_rad = autonomy::wrap_angle(s.psi_rad + dt_s * s.psi_dot_rad_s);
  return s;
}

/// autonomy's TrajectoryFollower, once per State from the first setpoint on. Setpoints older than
/// trajectory_timeout_s make commands that are not valid; without State there are none. While
/// something else is flown than its commands its integrals are zero.
class TrajectoryFollowerNode : public rclcpp::Node {
 public:
  TrajectoryFollowerNode()
      : Node("trajectory_follower"),
        config_{with_east(
            flight::read_multirotor_autonomy(ros_common::VehicleFile::declare(*this).read())
                .flight.follower)},
        parameters_{*this, follower_parameters(), config_},
        phase_{*this, [](const std::string&) {}},
        follower_{config_} {
    parameters_.on_change([this](const FollowerConfig& config) {
      follower_.configure(config);
      return "";
    });
    commands_ = create_publisher<ControllerCommand>("high_level_command", rclcpp::QoS(1));
    setpoints_ = create_subscription<TrajectoryCommand>(
        "trajectory_command", rclcpp::QoS(1),
        [this](TrajectoryCommand::ConstSharedPtr message) { received_ = Heard{*message, now()}; });
    status_ = create_subscription<Status>(
        "status", rclcpp::QoS(1), [this](Status::ConstSharedPtr message) {
          pilot_ = autonomy::PilotOverride::from_word(message->rc_override);
        });
    states_ = create_subscription<State>("estimated_state", rclcpp::QoS(1),
                                         [this](State::ConstSharedPtr message) { step(*message); });
    clear_ = create_service<Trigger>("trajectory_follower/clear_integrators",
                                     [this](const std::shared_ptr<Trigger::Request>,
                                            std::shared_ptr<Trigger::Response> response) {
                                       follower_.clear_integrators();
                                       response->success = true;
                                       response->message = "north, east, down and heading";
                                     });
  }

 private:
  struct Heard {
    TrajectoryCommand message;
    rclcpp::Time at;
  };
  static constexpr double kFarthest_s = 0.1;  // a setpoint is carried on

  void step(const State& message) {
    if (!received_) return;
    const double t_s = ros_common::seconds(message.header);
    const double dt_s = t_s - last_s_;
    last_s_ = t_s;
    if (!phase_.following()) follower_.restart(autonomy::Vector3::Zero());
    const autonomy::multirotor::State state = state_of(message);
    const autonomy::multirotor::AttitudeView attitude(state.q_WB);
    const double ahead_s =
        std::clamp(t_s - ros_common::seconds(received_->message.header), 0.0, kFarthest_s);
    const autonomy::multirotor::Trajectory setpoint =
        carried_on(trajectory_of(received_->message), ahead_s);
    const double age_s = (now() - received_->at).seconds();
    ControllerCommand out;
    fill(follower_.step({state, attitude, setpoint, age_s, dt_s, pilot_}), out);
    out.header.stamp = message.header.stamp;
    commands_->publish(out);
  }

  FollowerConfig config_;
  ros_common::LiveParameters<FollowerConfig> parameters_;
  FlightPhase phase_;
  autonomy::multirotor::TrajectoryFollower follower_;
  std::optional<Heard> received_;
  autonomy::PilotOverride pilot_{};
  double last_s_{};
  rclcpp::Publisher<ControllerCommand>::SharedPtr commands_;
  rclcpp::Subscription<TrajectoryCommand>::SharedPtr setpoints_;
  rclcpp::Subscription<Status>::SharedPtr status_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Service<Trigger>::SharedPtr clear_;
};

}  // namespace
}  // namespace rosflight::roscopter

int main(int argc, char** argv) {
  using rosflight::roscopter::TrajectoryFollowerNode;
  return rosflight::ros_common::run_node<TrajectoryFollowerNode>(argc, argv);
}
