// SPDX-License-Identifier: BSD-3-Clause
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/command.hpp>
#include <rosflight_msgs/msg/fence.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <std_srvs/srv/trigger.hpp>

#include "autonomy/fixedwing/guidance.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/limits_input.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosplane/conversions.hpp"
#include "rosplane/fixedwing_parameters.hpp"

namespace rosplane {

namespace autonomy = rosflight::autonomy;
namespace {

using rosplane_msgs::msg::CurrentPath;
using rosplane_msgs::msg::FlightPhase;
using rosplane_msgs::msg::State;
using rosplane_msgs::msg::Waypoint;
using std_srvs::srv::Trigger;

/// Guidance: which path is flown when, from take-off to landing. One path and one phase for a
/// state.
///
/// Without waypoints it circles the origin at default_altitude, from kGrace_s after the
/// first state on. It takes off neither with an empty battery nor with one that has not the cells of the vehicle file (LimitsInput).
///
/// A list that begins with the order to forget the one before is another mission; a longer one, other settings and other parameters
/// are the present one revised, which a return or a landing that was asked for outlasts.
///
/// Stops: without a state, or with one that cannot be flown on, nothing is published, so the
/// follower's path and the controller's commands grow old. Back after more than 10 s it holds, returns and
/// lands (GapWatch). Position not known: circles at a fixed bank (Guidance).
class PathManagerNode : public rclcpp::Node {
 public:
  explicit PathManagerNode(const rclcpp::NodeOptions& options)
      : Node("path_manager", options),
        config_{FixedWingConfig::declare(*this)},
        parameters_{*this, parameters(), config_},
        reader_{config_.min_airspeed_known_m_s, config_.flight.controller.airframe.gravity_m_s2},
        limits_{config_.flight.battery},
        guidance_{config_.flight, without_waypoints()} {
    parameters_.on_change([this](const FixedWingConfig& wanted) { return apply(wanted); });
    paths_ = create_publisher<CurrentPath>("current_path", rclcpp::QoS(10));
    phases_ = create_publisher<FlightPhase>("flight_phase", rclcpp::QoS(10));
    listen();
    serve("land", [this] { guidance_.request_land(); });
    serve("return_to_base", [this] { guidance_.request_return(); });
  }

 private:
  static constexpr double kGrace_s = 10.0;
  static constexpr double kOld_s = 0.2;  // of range, throttle and height wanted

  static FixedWingTable parameters() {
    using config::Range;
    using C = FixedWingConfig;
    return {{"current_path_pub_frequency", &C::rate_Hz, "Hz", Range::between(10.0, 1000.0),
             "maximum paths per second"},
            {"R_min", [](const C& c) { return c.flight.plan.radius_m; },
             [](C& c, double x) { c.flight.plan.radius_m = c.limits.plan.radius_m = x; }, "m",
             Range::between(5.0, 1000.0), "radius of turns"},
            {"default_airspeed", [](const C& c) { return c.flight.plan.airspeed_m_s; },
             [](C& c, double x) { c.flight.plan.airspeed_m_s = c.limits.plan.airspeed_m_s = x; },
             "m/s", Range::between(3.0, 100.0), "airspeed of waypoints without one"},
            {"default_altitude", &C::default_height_m, "m", Range::between(5.0, 10000.0),
             "height of the circle without waypoints"},
            {"orbit_last", &C::orbit_last, "circles the last waypoint for ever"}};
  }

  void listen() {
    states_ = create_subscription<State>("estimated_state", rosflight_common::stream(10),
                                         [this](State::ConstSharedPtr message) { step(*message); });
    waypoints_ = rosflight_common::create_latched_subscription<Waypoint>(
        *this, "waypoint_path", autonomy::kMaxWaypoints + 1,
        [this](Waypoint::ConstSharedPtr message) { take(*message); });
    settings_ = rosflight_common::create_latched_subscription<rosplane_msgs::msg::MissionSettings>(
        *this, "mission_settings", 1,
        [this](rosplane_msgs::msg::MissionSettings::ConstSharedPtr message) {
          const fixedwing::Mission before = head_;
          rosplane::take(*message, head_);
          if (!same_settings(before, head_)) revise(guidance_.output().waypoint);
        });
    fences_ = rosflight_common::create_latched_subscription<rosflight_msgs::msg::Fence>(
        *this, rosflight_common::kFenceTopic, 1,
        [this](rosflight_msgs::msg::Fence::ConstSharedPtr message) {
          if (!limits_.take(*message)) return;
          RCLCPP_INFO(get_logger(), "%s", limits_.fence_text().c_str());
          guidance_.set_fence(limits_.fence());
        });
    batteries_ = create_subscription<rosflight_msgs::msg::BatteryStatus>(
        "battery", rosflight_common::stream(),
        [this](rosflight_msgs::msg::BatteryStatus::ConstSharedPtr message) {
          limits_.take(*message,
                       rosflight_common::received_at(*this, message->header.stamp).seconds());
        });
    statuses_ = create_subscription<rosflight_msgs::msg::Status>(
        "status", rclcpp::QoS(10), [this](rosflight_msgs::msg::Status::ConstSharedPtr message) {
          status_.armed = message->armed;
          status_.offboard = message->offboard;
          status_.rc_override = message->rc_override;
          status_.failsafe = message->failsafe;
        });
    ranges_ = create_subscription<sensor_msgs::msg::Range>(
        "range", rclcpp::QoS(10), [this](sensor_msgs::msg::Range::ConstSharedPtr message) {
          range_ = *message;
          last_range_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    commands_ = create_subscription<rosflight_msgs::msg::Command>(
        "command", rclcpp::QoS(10), [this](rosflight_msgs::msg::Command::ConstSharedPtr message) {
          last_.throttle = wide(message->u[0]);
          constexpr double kFull = 1e-3;
          last_.throttle_full = last_.throttle >= config_.flight.controller.max_throttle - kFull;
        });
    wanted_ = create_subscription<rosplane_msgs::msg::ControllerCommands>(
        "controller_command", rclcpp::QoS(10),
        [this](rosplane_msgs::msg::ControllerCommands::ConstSharedPtr message) {
          last_.wanted_height_m = wide(message->h_c);
          last_wanted_ = rosflight_common::received_at(*this, message->header.stamp);
        });
  }

  template <class Act>
  void serve(const char* name, Act act) {
    services_.push_back(
        create_service<Trigger>(name, [this, act](const std::shared_ptr<Trigger::Request>,
                                                  std::shared_ptr<Trigger::Response> response) {
          const fixedwing::Phase phase = guidance_.output().phase;
          response->success =
              phase != fixedwing::Phase::kDisarmed && phase != fixedwing::Phase::kLanded;
          response->message = std::string("phase ") + fixedwing::name(phase);
          if (response->success) act();
        }));
  }

  bool old(const std::optional<rclcpp::Time>& received) const {
    return !received || (now() - *received).seconds() > kOld_s;
  }

  // ---- mission ----------------------------------------------------------------------------------

  fixedwing::Mission without_waypoints() const {
    fixedwing::Mission out;
    fixedwing::Waypoint circle;
    circle.p_W = {0.0, 0.0, -config_.default_height_m};
    circle.passing = fixedwing::Passing::kCircle;
    circle.turn = 1;
    circle.hold_indefinitely = true;
    out.waypoints.push_back(circle);
    out.at_end = autonomy::AtEnd::kHold;
    return out;
  }

  /// As ROSflight 2.x: the list is repeated. Kept when a list is cleared: a sender of settings sends new
  /// ones then, and they may arrive first.
  static fixedwing::Mission default_mission() {
    fixedwing::Mission out;
    out.at_end = autonomy::AtEnd::kCycle;
    return out;
  }

  void take(const Waypoint& message) {
    if (message.clear_wp_list) {
      list_.clear();
      new_mission();
      return;
    }
    list_.push_back(message);
    new_mission();
  }

  /// All that a MissionSettings has.
  static bool same_settings(const fixedwing::Mission& a, const fixedwing::Mission& b) {
    return a.at_end == b.at_end && a.takeoff_height_m == b.takeoff_height_m &&
           a.radius_m == b.radius_m && a.landing.aim_W == b.landing.aim_W &&
           a.landing.course_rad == b.landing.course_rad;
  }

  fixedwing::Mission mission(const FixedWingConfig& config) const {
    fixedwing::Mission out = list_.empty() ? without_waypoints() : head_;
    out.fence = limits_.fence();
    if (list_.empty()) return out;
    out.waypoints.clear();
    for (const Waypoint& message : list_) {
      out.waypoints.push_back(waypoint_of(message, origin_));
    }
    if (config.orbit_last) out.at_end = autonomy::AtEnd::kHold;
    fixedwing::close_mission(out);
    return out;
  }

  /// A longer list goes on with the waypoint that is flown to, or with the first new one. On the ground it is another mission too:
  /// after a landing it is flown.
  void new_mission() {
    const fixedwing::GuidanceOutput& flown = guidance_.output();
    const bool longer = list_.size() > flown_ && flown_ > 0;
    const bool on_ground =
        flown.phase == fixedwing::Phase::kDisarmed || flown.phase == fixedwing::Phase::kLanded;
    const std::size_t first = !longer ? 0 : (flown.mission_done ? flown_ : flown.waypoint);
    if (longer && !on_ground) {
      revise(first);
    } else {
      guidance_.set_mission(mission(config_), first);
    }
    flown_ = list_.size();
  }

  void revise(std::size_t next) { guidance_.revise_mission(mission(config_), next); }

  std::string apply(const FixedWingConfig& wanted) {
    fixedwing::Mission changed = mission(wanted);
    if (const auto fault = fixedwing::check_mission(changed, wanted.limits)) {
      return "waypoint " + std::to_string(fault->waypoint + 1) + ": found " + fault->found +
             ", allowed " + fault->allowed;
    }
    guidance_.configure(wanted.flight);
    guidance_.revise_mission(changed, guidance_.output().waypoint);
    return "";
  }

  // ---- flight -----------------------------------------------------------------------------------

  std::optional<double> range() const {
    const bool inside = range_.range >= range_.min_range && range_.range < range_.max_range;
    if (!inside || old(last_range_)) return {};
    return wide(range_.range);
  }

  void step(const State& message) {
    if (!origin_) {
      origin_ = origin_of(message);
      const auto& geodetic = [](const Waypoint& wp) { return wp.lla; };
      if (origin_ && std::any_of(list_.begin(), list_.end(), geodetic))
        revise(guidance_.output().waypoint);
    }
    const autonomy::StateEstimate& state = reader_.read(message);
    if (!flyable(state) || !thinning_.pass(state.t_s, config_.rate_Hz)) return;
    const double now_s = now().seconds();
    autonomy::Status status = status_;
    limits_.fill(now_s, status);
    if (!started_s_) started_s_ = state.t_s;
    const bool nothing_to_fly = list_.empty() && state.t_s - *started_s_ < kGrace_s;
    if (guidance_.output().phase == fixedwing::Phase::kDisarmed)
      status.armed = status.armed && !nothing_to_fly && battery_good(now_s);
    fixedwing::Guidance::Last last = last_;
    if (old(last_wanted_)) last.wanted_height_m.reset();
    const fixedwing::GuidanceOutput& out =
        guidance_.step({state.t_s, state, status, range(), last});
    log(out, now_s);
    if (out.act == fixedwing::GuidanceAct::kRepeat || out.act == fixedwing::GuidanceAct::kGiveUp)
      return;
    FlightPhase phase;
    put(out, phase);
    phase.header = message.header;
    phases_->publish(phase);
    if (!out.follow.valid) return;
    CurrentPath path;
    put(out.follow, state.p_W, path);
    path.header = message.header;
    paths_->publish(path);
  }

  bool battery_good(double now_s) {
    const std::string why = limits_.takeoff_fault(now_s);
    constexpr int kAgain_ms = 5000;
    if (!why.empty())
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kAgain_ms, "no take-off: %s", why.c_str());
    return why.empty();
  }

  void log(const fixedwing::GuidanceOutput& out, double now_s) {
    using Type = autonomy::FlightEventType;
    for (const autonomy::FlightEvent& event : out.events) {
      const std::string text =
          limits_.text(event.type, now_s, guidance_.limits().battery().charge());
      if (event.type == Type::kPhase) {
        const auto phase = static_cast<fixedwing::Phase>(event.index);
        RCLCPP_INFO(get_logger(), "phase %s", fixedwing::name(phase));
        const std::string unknown = limits_.not_judged(now_s);
        if (phase == fixedwing::Phase::kTakeoff && !unknown.empty())
          RCLCPP_WARN(get_logger(), "%s", unknown.c_str());
      } else if (event.type == Type::kWaypointReached) {
        RCLCPP_INFO(get_logger(), "waypoint %zu reached at %.1f m", event.index + 1, event.value);
      } else if (event.type == Type::kMissionDone || event.type == Type::kPilotGaveBack ||
                 event.type == Type::kFailsafeOver) {
        RCLCPP_INFO(get_logger(), "%s", text.c_str());
      } else if (event.type == Type::kBatteryLand) {
        RCLCPP_ERROR(get_logger(), "%s", text.c_str());
      } else {
        RCLCPP_WARN(get_logger(), "%s", text.c_str());
      }
    }
  }

  FixedWingConfig config_;
  FixedWingParameters parameters_;
  StateReader reader_;
  rosflight_common::LimitsInput limits_;
  fixedwing::Guidance guidance_;
  std::optional<double> started_s_;  ///< Time of the first state.
  std::vector<Waypoint> list_;
  fixedwing::Mission head_{default_mission()};
  std::size_t flown_{0};  ///< Waypoints that the guidance knows of.
  std::optional<autonomy::Geodetic> origin_;
  autonomy::Status status_{};
  fixedwing::Guidance::Last last_{};
  sensor_msgs::msg::Range range_;
  std::optional<rclcpp::Time> last_range_, last_wanted_;
  Thinning thinning_;
  rclcpp::Publisher<CurrentPath>::SharedPtr paths_;
  rclcpp::Publisher<FlightPhase>::SharedPtr phases_;
  rclcpp::Subscription<State>::SharedPtr states_;
  rclcpp::Subscription<Waypoint>::SharedPtr waypoints_;
  rclcpp::Subscription<rosplane_msgs::msg::MissionSettings>::SharedPtr settings_;
  rclcpp::Subscription<rosflight_msgs::msg::Fence>::SharedPtr fences_;
  rclcpp::Subscription<rosflight_msgs::msg::BatteryStatus>::SharedPtr batteries_;
  rclcpp::Subscription<rosflight_msgs::msg::Status>::SharedPtr statuses_;
  rclcpp::Subscription<sensor_msgs::msg::Range>::SharedPtr ranges_;
  rclcpp::Subscription<rosflight_msgs::msg::Command>::SharedPtr commands_;
  rclcpp::Subscription<rosplane_msgs::msg::ControllerCommands>::SharedPtr wanted_;
  std::vector<rclcpp::Service<Trigger>::SharedPtr> services_;
};

}  // namespace
}  // namespace rosplane

ROSFLIGHT_NODE(rosplane::PathManagerNode, SingleThreadedExecutor)
