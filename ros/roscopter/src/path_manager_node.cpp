// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/fence.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "autonomy/common/flight_limits.hpp"
#include "autonomy/multirotor/angles.hpp"
#include "autonomy/multirotor/path_manager.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "roscopter/conversions.hpp"
#include "roscopter/flight_phase.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/limits_input.hpp"
#include "rosflight_common/live_parameters.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_common/vehicle_file.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace flight = rosflight::flight;
namespace {

using autonomy::multirotor::PathConfig;
using autonomy::multirotor::PathManager;
using roscopter_msgs::msg::State;
using roscopter_msgs::msg::TrajectoryCommand;
using roscopter_msgs::msg::Waypoint;
using rosflight_msgs::msg::BatteryStatus;
using rosflight_msgs::msg::Fence;
using std_srvs::srv::Trigger;

config::Table<PathConfig> path_parameters() {
  using autonomy::multirotor::Interpolation;
  using autonomy::multirotor::LegLimits;
  using config::at;
  using config::Range;
  using C = PathConfig;
  return {
      {"max_velocity", at(&C::limits, &LegLimits::speed_m_s), "m/s", Range::between(0.1, 50.0),
       "maximum speed of legs"},
      {"max_acceleration", at(&C::limits, &LegLimits::acceleration_m_s2), "m/s^2",
       Range::between(0.1, 50.0), "maximum acceleration of legs"},
      {"waypoint_tolerance", &C::waypoint_tolerance_m, "m", Range::between(0.01, 100.0),
       "distance at which a waypoint is reached"},
      {"arrival_timeout_s", &C::arrival_timeout_s, "s", Range::between(0.1, 3600.0),
       "maximum wait for the vehicle at the end of a leg"},
      {"do_linear_interpolation",
       [](const C& c) { return c.interpolation == Interpolation::kLinear; },
       [](C& c, bool on) {
         c.interpolation = on ? Interpolation::kLinear : Interpolation::kQuintic;
       },
       "legs at constant acceleration instead of quintics"},
      {"hold_last", [](const C& c) { return !c.cycle; }, [](C& c, bool on) { c.cycle = !on; },
       "stay at the last waypoint, else fly to the first again; a mission's at_end counts more"}};
}

/// Turns waypoints into a trajectory: autonomy's PathManager, one setpoint per State.
///
/// The clock of the path runs while the controller publishes "offboard" on `flight_phase`; until then
/// the setpoint is where the vehicle is. If nobody publishes a phase the path begins with the
/// first waypoint. After the last waypoint of a mission that ends in a landing it calls
/// controller/land; so it does after path_manager/return_to_base, above where it took off.
///
/// Battery and fence (autonomy's FlightLimits) let it return or land, as in FlightManager. Without a take-off that it has seen there
/// is no place to return to and no fence, and without waypoints another node leads: then it lands instead. A list that begins with the order to forget the one before ends a return, but
/// for one that the battery asks for; a waypoint that is added meanwhile is for the next flight.
///
/// Without State nothing goes out, and nothing without a waypoint on the ground; a list that is
/// cleared in flight leaves the setpoint where it is.
class PathManagerNode : public rclcpp::Node {
 public:
  explicit PathManagerNode(const rclcpp::NodeOptions& options)
      : Node("path_manager", options),
        config_{flight::read_multirotor_autonomy(
                    rosflight_common::VehicleFile::declare(*this, kUsualVehicle).read())
                    .flight},
        parameters_{*this, path_parameters(), config_.path},
        limits_input_{config_.battery},
        phase_{*this, [this](const std::string& phase) { enter(phase); }} {
    const double rate_Hz = rosflight_common::declare_number(
        *this, "path_update_frequency", 100.0, 1.0, 1000.0, "maximum setpoints per second [Hz]");
    interval_s_ = kAlmost / rate_Hz;
    parameters_.on_change([this](const PathConfig& config) {
      path_.configure(in_force(config));
      return "";
    });
    path_.configure(in_force(config_.path));
    limits_.start(config_.battery, {});
    setpoints_ = create_publisher<TrajectoryCommand>("trajectory_command", rclcpp::QoS(1));
    waypoints_ = rosflight_common::create_latched_subscription<Waypoint>(
        *this, "waypoints", autonomy::kMaxWaypoints + 1,
        [this](Waypoint::ConstSharedPtr message) { take(*message); });
    at_end_ = rosflight_common::create_latched_subscription<std_msgs::msg::String>(
        *this, "mission/at_end", 1, [this](std_msgs::msg::String::ConstSharedPtr message) {
          end_ = message->data;
          path_.configure(in_force(config_.path));
        });
    batteries_ = create_subscription<BatteryStatus>(
        "battery", rosflight_common::stream(),
        [this](BatteryStatus::ConstSharedPtr message) { limits_input_.take(*message, state_s_); });
    fences_ = rosflight_common::create_latched_subscription<Fence>(
        *this, rosflight_common::kFenceTopic, 1, [this](Fence::ConstSharedPtr message) {
          if (!limits_input_.take(*message)) return;
          RCLCPP_INFO(get_logger(), "%s", limits_input_.fence_text().c_str());
          limits_.set_fence(limits_input_.fence());
        });
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(),
                                         [this](State::ConstSharedPtr message) { step(*message); });
    land_ = create_client<Trigger>("controller/land");
    clear_ = create_service<Trigger>(
        "path_manager/clear_waypoints", [this](const std::shared_ptr<Trigger::Request>,
                                               std::shared_ptr<Trigger::Response> response) {
          response->success = true;
          response->message = std::to_string(count()) + " waypoints forgotten";
          clear();
        });
    print_ = create_service<Trigger>(
        "path_manager/print_waypoints", [this](const std::shared_ptr<Trigger::Request>,
                                               std::shared_ptr<Trigger::Response> response) {
          for (const autonomy::multirotor::Waypoint& wp : path_.waypoints()) {
            RCLCPP_INFO(get_logger(), "north %.2f, east %.2f, down %.2f m", wp.p_W.x(), wp.p_W.y(),
                        wp.p_W.z());
          }
          response->success = true;
          response->message = std::to_string(count()) + " waypoints";
        });
    return_ = create_service<Trigger>("path_manager/return_to_base",
                                      [this](const std::shared_ptr<Trigger::Request>,
                                             std::shared_ptr<Trigger::Response> response) {
                                        const char* why = why_no_return();
                                        response->success = *why == '\0';
                                        response->message = response->success ? "returning" : why;
                                        if (!response->success) return;
                                        RCLCPP_WARN(get_logger(), "returning to where it took off");
                                        begin_return();
                                      });
  }

 private:
  static constexpr double kAlmost = 0.9;  // of a period: jitter of stamps must not drop setpoints
  static constexpr double kBack_s = 1.0;

  std::size_t count() const { return path_.waypoints().size() + geodetic_.size(); }

  PathConfig in_force(PathConfig config) const {
    if (!end_.empty()) config.cycle = end_ == "cycle";
    config.cycle = config.cycle && !returning_;
    return config;
  }

  const char* why_no_return() {
    if (!home_W_) return "found no take-off, allowed after one";
    if (!path_.started() || !phase_.following()) return "found no path in flight, allowed on one";
    return returning_ ? "found a return, allowed once in a flight" : "";
  }

  void begin_return() {
    returning_ = true;
    done_ = false;
    mission_ = path_.waypoints();
    path_.configure(in_force(config_.path));
    lead_back(setpoint_.p_W, setpoint_.psi_rad);
  }

  void lead_back(const autonomy::Vector3& from_W, double psi_rad) {
    path_.set_waypoints(autonomy::multirotor::path_back(
        from_W, *home_W_, config_.return_height_m,
        autonomy::return_ceiling_m(limits_input_.fence()), psi_rad));
  }

  /// What a fence has asked for is over. What the battery asks for is not: the next State returns again.
  void clear() {
    geodetic_.clear();
    path_.set_waypoints({});
    limits_.set_fence(limits_input_.fence());
    done_ = returning_ = false;
    path_.configure(in_force(config_.path));
  }

  void take(const Waypoint& message) {
    if (message.clear_wp_list) {
      clear();
      return;
    }
    if (message.use_lla && !origin_) {
      geodetic_.push_back(message);  // until a state contains the origin
      return;
    }
    append(message);
  }

  void append(const Waypoint& message) {
    autonomy::multirotor::Waypoint waypoint = waypoint_of(message);
    if (message.use_lla && origin_) {
      waypoint.p_W =
          autonomy::ned_of({waypoint.p_W.x(), waypoint.p_W.y(), waypoint.p_W.z()}, *origin_);
    }
    if (!waypoint.p_W.allFinite() || !std::isfinite(waypoint.psi_rad)) {
      RCLCPP_ERROR(get_logger(), "waypoints: found numbers that are not finite, not used");
      return;
    }
    if (returning_) {
      constexpr int kAgain_ms = 5000;
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kAgain_ms,
                           "waypoints: found one during a return, kept for the next flight");
      mission_.push_back(waypoint);
      return;
    }
    path_.append(waypoint);
    done_ = false;
  }

  void enter(const std::string& phase) {
    if (phase != kTakeoff) return;
    home_W_ = place_W_;
    limits_.start(config_.battery, limits_input_.fence());
    const std::string unknown = limits_input_.not_judged(state_s_);
    if (!unknown.empty()) RCLCPP_WARN(get_logger(), "%s", unknown.c_str());
    if (!returning_) mission_ = path_.waypoints();
    returning_ = false;
    path_.configure(in_force(config_.path));
    path_.set_waypoints(mission_);  // from the first on
    done_ = false;
  }

  void step(const State& message) {
    if (!origin_) origin_ = origin_of(message);
    if (origin_ && !geodetic_.empty()) {
      for (const Waypoint& waypoint : geodetic_) append(waypoint);
      geodetic_.clear();
    }
    const autonomy::multirotor::State state = state_of(message);
    const double t_s = rosflight_common::seconds(message.header);
    state_s_ = t_s;
    if (t_s < last_s_ - kBack_s) last_s_ = t_s - 1.0;  // the clock was set back
    const bool good =
        state.p_W.allFinite() && state.v_W.allFinite() && state.q_WB.coeffs().allFinite();
    if (!good || t_s - last_s_ < interval_s_) return;
    const double dt_s = std::isfinite(last_s_) ? t_s - last_s_ : 0.0;
    last_s_ = t_s;
    place_W_ = state.p_W;
    judge(dt_s);
    const double psi_rad = autonomy::multirotor::AttitudeView(state.q_WB).psi_rad;
    const bool fly = phase_.following();
    if (!fly) path_.stop();
    if (!path_.started()) {
      setpoint_ = {};
      setpoint_.p_W = state.p_W;
      setpoint_.psi_rad = psi_rad;
      if (path_.waypoints().empty()) return;
      if (fly && returning_) lead_back(state.p_W, psi_rad);
      if (fly) path_.start(t_s, autonomy::multirotor::path_start(state, psi_rad, setpoint_));
    }
    if (path_.started()) follow(path_.step(t_s, state.p_W, psi_rad));
    TrajectoryCommand out;
    fill(setpoint_, out);
    out.header.stamp = message.header.stamp;
    out.header.frame_id = "NED";
    setpoints_->publish(out);
  }

  /// What battery and fence ask for.
  void judge(double dt_s) {
    if (!phase_.flying()) return;
    autonomy::Status status;
    limits_input_.fill(state_s_, status);
    autonomy::Vector3 from_start_W = autonomy::Vector3::Constant(std::nan(""));
    if (home_W_) from_start_W = *place_W_ - *home_W_;
    autonomy::FlightEvents events;
    limits_.step(status, from_start_W, dt_s, events);
    for (const autonomy::FlightEvent& event : events) report(event.type);
    const bool back = limits_.asks_return();
    if (limits_.asks_land() || (back && *why_not_back() != '\0')) {
      ask_for_landing();
    } else if (back && !returning_ && !phase_.landing()) {
      begin_return();
    }
  }

  /// Why it lands instead of a return; empty: it returns.
  const char* why_not_back() const {
    if (!home_W_) return ", lands: no take-off was seen";
    const bool leads = path_.started() || !path_.waypoints().empty();
    return leads ? "" : ", lands: the commands that are flown are not this path's";
  }

  void report(autonomy::FlightEventType type) {
    const std::string text = limits_input_.text(type, state_s_, limits_.battery().charge());
    if (type == autonomy::FlightEventType::kBatteryLand) {
      RCLCPP_ERROR(get_logger(), "%s", text.c_str());
    } else {
      const bool back = limits_.asks_return();
      RCLCPP_WARN(get_logger(), "%s%s", text.c_str(), back ? why_not_back() : "");
    }
  }

  /// Once a second until the controller lands.
  void ask_for_landing() {
    constexpr double kAgain_s = 1.0;
    if (phase_.landing() || last_s_ < land_asked_s_ + kAgain_s) return;
    land_asked_s_ = last_s_;
    if (land_->service_is_ready()) {
      land_->async_send_request(std::make_shared<Trigger::Request>());
    } else {
      RCLCPP_ERROR(get_logger(),
                   "controller/land: nobody serves it, found a battery that asks for it");
    }
  }

  void follow(const PathManager::Output& path) {
    setpoint_ = path.setpoint;
    if (path.event != PathManager::Event::kNone && !returning_) {
      const bool reached = path.event == PathManager::Event::kReached;
      RCLCPP_INFO(get_logger(), "waypoint %zu %s at %.2f m", path.event_waypoint + 1,
                  reached ? "reached" : "missed", path.event_distance_m);
    }
    if (!path.done || done_) return;
    const bool land = end_ == "land" || returning_;
    if (land && !land_->service_is_ready()) {
      constexpr int kInterval_ms = 5000;
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms,
                           "controller/land: nobody serves it, holding at the last waypoint");
      return;
    }
    done_ = true;
    RCLCPP_INFO(get_logger(), returning_ ? "returned" : "mission done");
    if (land) land_->async_send_request(std::make_shared<Trigger::Request>());
  }

  autonomy::multirotor::FlightConfig config_;
  rosflight_common::LiveParameters<PathConfig> parameters_;
  rosflight_common::LimitsInput limits_input_;
  /// Stamp of the latest State [s]: the only time that this node knows.
  double state_s_{-std::numeric_limits<double>::infinity()};
  autonomy::FlightLimits limits_;
  FlightPhase phase_;
  PathManager path_;
  autonomy::multirotor::Trajectory setpoint_{};
  std::vector<Waypoint> geodetic_;
  std::optional<autonomy::Geodetic> origin_;
  std::string end_;  ///< What the mission says, if anything.
  double interval_s_{};
  double last_s_{-autonomy::kInfinity};
  double land_asked_s_{-autonomy::kInfinity};
  bool done_{false};
  bool returning_{false};
  std::vector<autonomy::multirotor::Waypoint> mission_;  ///< Without the return.
  std::optional<Eigen::Vector3d> place_W_, home_W_;      ///< Last State; take-off.
  rclcpp::Publisher<TrajectoryCommand>::SharedPtr setpoints_;
  rclcpp::Subscription<Waypoint>::SharedPtr waypoints_;
  rclcpp::Subscription<std_msgs::msg::String>::SharedPtr at_end_;
  rclcpp::Subscription<BatteryStatus>::SharedPtr batteries_;
  rclcpp::Subscription<Fence>::SharedPtr fences_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Client<Trigger>::SharedPtr land_;
  rclcpp::Service<Trigger>::SharedPtr clear_;
  rclcpp::Service<Trigger>::SharedPtr print_;
  rclcpp::Service<Trigger>::SharedPtr return_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::PathManagerNode, SingleThreadedExecutor)
