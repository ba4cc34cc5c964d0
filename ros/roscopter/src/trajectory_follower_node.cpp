// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <std_srvs/srv/trigger.hpp>

#include "autonomy/multirotor/trajectory_follower.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "roscopter/conversions.hpp"
#include "roscopter/flight_phase.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/live_parameters.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_common/vehicle_file.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace flight = rosflight::flight;
namespace {

using autonomy::multirotor::FollowerConfig;
using roscopter_msgs::msg::ControllerCommand;
using roscopter_msgs::msg::State;
using roscopter_msgs::msg::TrajectoryCommand;
using rosflight_msgs::msg::Status;
using std_srvs::srv::Trigger;

config::Table<FollowerConfig> follower_parameters() {
  using config::Range;
  using C = FollowerConfig;
  constexpr config::Unit kDown{"weights", -1.0};  // the parameter counts downwards
  const auto gains = [](const char* prefix, auto member, const char* text) {
    return rosflight_common::gains_row<C>(prefix, member, "", Range::between(-1000.0, 1000.0),
                                          text);
  };
  const char* position = "gain from the position error to the acceleration";
  return {
      {"gravity", &C::gravity_m_s2, "m/s^2", Range::between(9.0, 10.0), "gravity"},
      {"mass", &C::mass_kg, "kg", Range::between(0.01, 1000.0), "mass of the vehicle"},
      {"down_command_window", &C::max_position_error_m, "m", Range::between(0.1, 100.0),
       "position error is limited to this"},
      {"max_commanded_down_accel_in_gs", &C::min_lift_ratio, kDown, Range::between(-0.95, -0.05),
       "minimum upward thrust as a share of the weight, negative"},
      {"trajectory_timeout_s", &C::timeout_s, "s", Range::between(0.01, 60.0),
       "maximum age of a setpoint that is followed"},
      gains("u_n", &C::horizontal, position),
      gains(
          "u_e", [](C& c) -> auto& { return *c.east; },
          position),  // with_east has given it a value
      gains("u_d", &C::vertical, position),
      gains("yaw_to_rate", &C::heading, "gain from the heading error to the yaw rate")};
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
  explicit TrajectoryFollowerNode(const rclcpp::NodeOptions& options)
      : Node("trajectory_follower", options),
        config_{with_east(flight::read_multirotor_autonomy(
                              rosflight_common::VehicleFile::declare(*this, kUsualVehicle).read())
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
        "trajectory_command", rosflight_common::stream(),
        [this](TrajectoryCommand::ConstSharedPtr message) {
          received_ =
              Received{*message, rosflight_common::received_at(*this, message->header.stamp)};
        });
    status_ = create_subscription<Status>(
        "status", rclcpp::QoS(1), [this](Status::ConstSharedPtr message) {
          pilot_ = autonomy::PilotOverride::from_word(message->rc_override);
        });
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
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
  struct Received {
    TrajectoryCommand message;
    rclcpp::Time at;
  };
  static constexpr double kMaxAhead_s = 0.1;  // a setpoint is carried on

  void step(const State& message) {
    if (!received_) return;
    const double t_s = rosflight_common::seconds(message.header);
    const double dt_s = t_s - last_s_;
    last_s_ = t_s;
    if (!phase_.following()) follower_.restart(autonomy::Vector3::Zero());
    const autonomy::multirotor::State state = state_of(message);
    const autonomy::multirotor::AttitudeView attitude(state.q_WB);
    const double ahead_s =
        std::clamp(t_s - rosflight_common::seconds(received_->message.header), 0.0, kMaxAhead_s);
    const autonomy::multirotor::Trajectory setpoint =
        carried_on(trajectory_of(received_->message), ahead_s);
    const double age_s = std::max(0.0, (now() - received_->at).seconds());
    ControllerCommand out;
    fill(follower_.step({state, attitude, setpoint, age_s, dt_s, pilot_}), out);
    out.header.stamp = message.header.stamp;
    commands_->publish(out);
  }

  FollowerConfig config_;
  rosflight_common::LiveParameters<FollowerConfig> parameters_;
  FlightPhase phase_;
  autonomy::multirotor::TrajectoryFollower follower_;
  std::optional<Received> received_;
  autonomy::PilotOverride pilot_{};
  double last_s_{};
  rclcpp::Publisher<ControllerCommand>::SharedPtr commands_;
  rclcpp::Subscription<TrajectoryCommand>::SharedPtr setpoints_;
  rclcpp::Subscription<Status>::SharedPtr status_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Service<Trigger>::SharedPtr clear_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::TrajectoryFollowerNode, SingleThreadedExecutor)
