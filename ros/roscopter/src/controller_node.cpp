// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <std_msgs/msg/float64.hpp>
#include <std_msgs/msg/string.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <utility>
#include <vector>

#include "autonomy/multirotor/commanded_flight.hpp"
#include "flight/vehicle/mixer_fault.hpp"
#include "flight/vehicle/vehicle_setup.hpp"
#include "roscopter/controller_parameters.hpp"
#include "roscopter/conversions.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/firmware_parameters.hpp"
#include "rosflight_common/latched.hpp"
#include "rosflight_common/limits_input.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_common/vehicle_file.hpp"

namespace roscopter {

namespace autonomy = rosflight::autonomy;
namespace config = rosflight::config;
namespace flight = rosflight::flight;
namespace {

using autonomy::multirotor::CommandedFlight;
using autonomy::multirotor::Phase;
using roscopter_msgs::msg::ControllerCommand;
using roscopter_msgs::msg::State;
using rosflight_common::FirmwareParameters;
using rosflight_msgs::msg::BatteryStatus;
using rosflight_msgs::msg::Command;
using rosflight_msgs::msg::Status;
using std_srvs::srv::Trigger;

/// autonomy's CommandedFlight, state machine and controller, once per State.
///
/// Without State or Status for their timeouts the vehicle is handed to the pilot: one Command with
/// all entries ignored, then silence. Without commands it holds where it is and lands after
/// lost_command_land_s. It publishes its phase on `flight_phase` and lands by `controller/land`. What a throttle does is read from
/// the flight controller (FirmwareParameters): without its parameters, or with ones that cannot carry the vehicle, it does not take
/// off; nor does it with a battery that would end the flight at once (LimitsInput).
class ControllerNode : public rclcpp::Node {
 public:
  explicit ControllerNode(const rclcpp::NodeOptions& options)
      : Node("controller", options),
        vehicle_{rosflight_common::VehicleFile::declare(*this, kUsualVehicle).read()},
        config_{flight::read_multirotor_autonomy(vehicle_).flight},
        tuning_{tuning_of(config_)},
        parameters_{*this, controller_parameters(), tuning_},
        battery_{config_.battery} {
    state_timeout_s_ = rosflight_common::declare_number(
        *this, "state_timeout_s", 0.25, 0.01, 10.0,
        "time without a state after which the pilot has control [s]");
    status_timeout_s_ = rosflight_common::declare_number(
        *this, "status_timeout_s", 2.0, 0.1, 60.0,
        "time without a status after which the pilot has control [s]");
    const std::string why = fault(tuning_);
    if (!why.empty()) throw config::Error("parameter " + why);
    parameters_.on_change([this](const Tuning& tuning) {
      std::string refusal = fault(tuning);
      if (refusal.empty()) control_.configure(tuning.controller, with_mission(tuning.states));
      return refusal;
    });
    control_ = CommandedFlight(tuning_.controller, config_.thrust);
    control_.renew(tuning_.states);
    if (rosflight_common::declare_switch(
            *this, "use_firmware_parameters", true,
            "reads the thrust of a throttle from the flight controller; "
            "false: from the vehicle file")) {
      const auto& names = flight::kThrustParameters;
      motors_.emplace(*this, std::vector<std::string>(names.begin(), names.end()),
                      std::chrono::milliseconds(20), FirmwareParameters::Repeat::kForever,
                      [this](const FirmwareParameters::Values& values) { learn(values); });
    }
    open();
  }

 private:
  using FlightConfig = autonomy::multirotor::FlightConfig;

  static Tuning tuning_of(const FlightConfig& config) {
    Tuning tuning{config.controller, config.states};
    auto& c = tuning.controller;
    if (!c.position_east) c.position_east = c.position_horizontal;
    if (!c.velocity_east) c.velocity_east = c.velocity_horizontal;
    return tuning;
  }

  /// What no range of a single parameter can say; empty if all is well.
  std::string fault(const Tuning& tuning) const {
    const auto& c = tuning.controller;
    const auto& s = tuning.states;
    const double weight_N = c.mass_kg * c.gravity_m_s2;
    if (c.min_throttle >= c.max_throttle)
      return "min_throttle: found " + config::number_text(c.min_throttle) +
             ", allowed less than max_throttle, " + config::number_text(c.max_throttle);
    if (config_.thrust.max_thrust_N() < 1.1 * weight_N)
      return "mass: found " + config::number_text(c.mass_kg) + ", allowed what full throttle of " +
             config::number_text(config_.thrust.max_thrust_N()) + " N carries";
    if (s.takeoff_tolerance_m >= s.takeoff_height_m)
      return "takeoff_height_threshold: found " + config::number_text(s.takeoff_tolerance_m) +
             ", allowed less than the height of the take-off, " +
             config::number_text(s.takeoff_height_m);
    return "";
  }

  /// The motor model of the flight controller, or why it cannot fly this vehicle.
  void learn(const FirmwareParameters::Values& values) {
    const std::string before = std::exchange(motor_fault_, motor_fault(values));
    if (motor_fault_.empty()) {
      if (!before.empty())
        RCLCPP_INFO(get_logger(),
                    "thrust as the flight controller makes it: USE_MOTOR_PARAM %g, RC_MAX_THR %g, "
                    "%.1f N at full throttle",
                    values.at("USE_MOTOR_PARAM"), values.at("RC_MAX_THR"),
                    config_.thrust.max_thrust_N());
      control_.set_thrust_model(config_.thrust);
    } else {
      RCLCPP_ERROR(get_logger(), "no take-off: %s", motor_fault_.c_str());
    }
  }

  std::string motor_fault(const FirmwareParameters::Values& values) {
    const auto rotors = flight::read_rotors(vehicle_);
    std::string mixer =
        flight::mixer_fault(static_cast<int>(values.at("PRIMARY_MIXER")), rotors.rotors.size());
    if (!mixer.empty()) return mixer;
    const double count = values.at("NUM_MOTORS");
    if (values.at("USE_MOTOR_PARAM") != 0.0 && count != static_cast<double>(rotors.rotors.size()))
      return "NUM_MOTORS: found " + config::number_text(count) + ", allowed " +
             std::to_string(rotors.rotors.size()) + ", as many rotors as the vehicle file has";
    rosflight::companion::ParameterSet set;
    for (const auto& [name, value] : values)
      set.push_back({name, rosflight::companion::ParameterValue::of(static_cast<float>(value))});
    try {
      config_.thrust = flight::read_multirotor_autonomy(vehicle_, rotors, set).flight.thrust;
    } catch (const std::exception& why) {
      std::string reason = why.what();
      if (const auto at = reason.find("autonomy: "); at != std::string::npos)
        reason.erase(0, at + std::string("autonomy: ").size());
      return "USE_MOTOR_PARAM " + config::number_text(values.at("USE_MOTOR_PARAM")) +
             ", RC_MAX_THR " + config::number_text(values.at("RC_MAX_THR")) +
             " and motor parameters of the flight controller: " + reason;
    }
    return "";
  }

  bool motors_known() {
    if (!motors_ || (motors_->complete() && motor_fault_.empty())) return true;
    if (status_.armed) {
      constexpr int kAgain_ms = 5000;
      const std::string why =
          motors_->complete() ? motor_fault_
                              : motors_->missing() + " of the flight controller is not known yet";
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kAgain_ms, "no take-off: %s", why.c_str());
    }
    return false;
  }

  /// A battery that is empty, or that has not the cells of the vehicle file: else the flight would end as soon as it has begun.
  bool battery_good(const rclcpp::Time& time) {
    const std::string why = battery_.takeoff_fault(time.seconds());
    if (!why.empty() && status_.armed && control_.output().phase == Phase::kDisarmed) {
      constexpr int kAgain_ms = 5000;
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kAgain_ms, "no take-off: %s", why.c_str());
    }
    return why.empty();
  }

  autonomy::multirotor::StateMachineConfig with_mission(
      autonomy::multirotor::StateMachineConfig states) const {
    if (std::isfinite(mission_height_m_)) states.takeoff_height_m = mission_height_m_;
    return states;
  }

  void open() {
    const auto newest = rclcpp::QoS(1);
    out_ = create_publisher<Command>("command", newest);
    phase_ =
        rosflight_common::create_latched_publisher<std_msgs::msg::String>(*this, "flight_phase", 1);
    publish_phase();
    given_sub_ = create_subscription<ControllerCommand>(
        "high_level_command", rosflight_common::stream(),
        [this](ControllerCommand::ConstSharedPtr message) {
          given_ = command_of(*message);
          given_at_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    status_sub_ =
        create_subscription<Status>("status", newest, [this](Status::ConstSharedPtr message) {
          status_.armed = message->armed;
          status_.offboard = message->offboard;
          status_.rc_override = message->rc_override;
          status_.failsafe = message->failsafe;
          status_at_ = rosflight_common::received_at(*this, message->header.stamp);
        });
    battery_sub_ = create_subscription<BatteryStatus>(
        "battery", newest, [this](BatteryStatus::ConstSharedPtr message) {
          battery_.take(*message,
                        rosflight_common::received_at(*this, message->header.stamp).seconds());
        });
    height_sub_ = rosflight_common::create_latched_subscription<std_msgs::msg::Float64>(
        *this, "mission/takeoff_height", 1, [this](std_msgs::msg::Float64::ConstSharedPtr message) {
          mission_height_m_ = message->data;
          control_.configure(tuning_.controller, with_mission(tuning_.states));
        });
    state_sub_ =
        create_subscription<State>("estimated_state", rosflight_common::stream(),
                                   [this](State::ConstSharedPtr message) { step(*message); });
    land_ = create_service<Trigger>(
        "controller/land", [this](const std::shared_ptr<Trigger::Request>,
                                  std::shared_ptr<Trigger::Response> response) {
          response->success = !control_.on_ground();
          response->message = response->success
                                  ? "landing"
                                  : std::string("found phase ") +
                                        autonomy::multirotor::name(control_.output().phase) +
                                        ", allowed in flight";
          if (response->success) control_.request_land();
        });
    watch_ = rclcpp::create_timer(this, get_clock(), rclcpp::Duration::from_seconds(kWatch_s),
                                  [this] { watch(); });
  }

  void step(const State& message) {
    if (!status_at_) return;
    const rclcpp::Time arrived = rosflight_common::received_at(*this, message.header.stamp);
    const double t_s = rosflight_common::seconds(message.header);
    if (t_s < last_s_ - kBack_s) {
      RCLCPP_WARN(get_logger(), "ROS time jumped back %.1f s; controller reset", last_s_ - t_s);
      control_ = CommandedFlight(tuning_.controller, config_.thrust);
      control_.renew(with_mission(tuning_.states));
    }
    last_s_ = t_s;
    state_at_ = arrived;
    if (silent_ && (arrived - *status_at_).seconds() > status_timeout_s_) return;
    silent_ = false;
    const double age_s = given_at_ ? (arrived - *given_at_).seconds() : autonomy::kInfinity;
    const bool good = control_.command_good(given_, std::max(age_s, 0.0));
    const autonomy::multirotor::State state = state_of(message);
    battery_.fill(arrived.seconds(), status_);
    const bool ready = good && !flown_ && motors_known() && battery_good(arrived);
    using Turn = CommandedFlight::Turn;
    const Turn turn = control_.begin(
        {.t_s = t_s, .state = state, .status = status_, .ready = ready, .command_good = good});
    if (turn == Turn::kOwn || turn == Turn::kFollow) control_.finish(state, given_);
    note();
    publish(message.header.stamp);
  }

  void publish(const builtin_interfaces::msg::Time& stamp) {
    Command out;
    fill(control_.output().command, out);
    out.header.stamp = stamp;
    out_->publish(out);
  }

  void note() {
    using Type = autonomy::FlightEventType;
    for (const autonomy::FlightEvent& event : control_.output().events) {
      switch (event.type) {
        case Type::kPhase:
          enter(control_.output().phase);
          break;
        case Type::kTakeoffFailed:
          RCLCPP_ERROR(get_logger(), "take-off failed");
          break;
        case Type::kPilotTookOver:
          RCLCPP_WARN(get_logger(), "pilot took over");
          break;
        case Type::kPilotGaveBack:
          RCLCPP_INFO(get_logger(), "pilot gave back");
          break;
        case Type::kStateLost:
          RCLCPP_ERROR(get_logger(), "state lost: the vehicle is the pilot's");
          break;
        case Type::kStateRegained:
          RCLCPP_INFO(get_logger(), "state regained");
          break;
        case Type::kFailsafeFlies:
          RCLCPP_WARN(get_logger(), "%s", autonomy::name(event.type));
          break;
        case Type::kFailsafeOver:
          RCLCPP_INFO(get_logger(), "%s", autonomy::name(event.type));
          break;
        case Type::kThrustFault:
          RCLCPP_WARN(get_logger(), "%s (climb %.1f m/s)", autonomy::name(event.type), event.value);
          break;
        default:
          break;
      }
    }
  }

  void enter(Phase phase) {
    publish_phase();
    RCLCPP_INFO(get_logger(), "phase %s%s", autonomy::multirotor::name(phase),
                phase == Phase::kLanded ? ": disarm" : "");
    if (phase == Phase::kLanded) flown_ = true;
    if (phase != Phase::kDisarmed) return;
    flown_ = false;  // arming again means flying again
    control_.renew(with_mission(tuning_.states));
  }

  void publish_phase() {
    std_msgs::msg::String message;
    message.data = autonomy::multirotor::name(control_.output().phase);
    phase_->publish(message);
  }

  /// Detects that no message arrives.
  void watch() {
    if (silent_ || !state_at_ || !status_at_) return;
    const rclcpp::Time time = now();
    const bool no_state = (time - *state_at_).seconds() > state_timeout_s_;
    const bool no_status = (time - *status_at_).seconds() > status_timeout_s_;
    if (!no_state && !no_status) return;
    silent_ = true;
    control_.lose_state();
    RCLCPP_ERROR(get_logger(), "%s is silent: the vehicle is the pilot's",
                 no_state ? "estimated_state" : "status");
    publish(time);
  }

  static constexpr double kWatch_s = 0.05;
  static constexpr double kBack_s = 1.0;

  rosflight::sim::Vehicle vehicle_;
  FlightConfig config_;
  Tuning tuning_;
  rosflight_common::LiveParameters<Tuning> parameters_;
  CommandedFlight control_;
  std::optional<FirmwareParameters> motors_;
  std::string motor_fault_;
  rosflight_common::LimitsInput battery_;
  autonomy::Status status_{};
  autonomy::multirotor::ControllerCommand given_{};
  std::optional<rclcpp::Time> given_at_;
  std::optional<rclcpp::Time> status_at_;
  std::optional<rclcpp::Time> state_at_;
  double mission_height_m_{std::numeric_limits<double>::quiet_NaN()};
  double state_timeout_s_{};
  double status_timeout_s_{};
  double last_s_{};
  bool silent_{false};
  bool flown_{false};
  rclcpp::Publisher<Command>::SharedPtr out_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr phase_;
  rclcpp::Subscription<ControllerCommand>::SharedPtr given_sub_;
  rclcpp::Subscription<Status>::SharedPtr status_sub_;
  rclcpp::Subscription<BatteryStatus>::SharedPtr battery_sub_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr height_sub_;
  rclcpp::Subscription<State>::SharedPtr state_sub_;
  rclcpp::Service<Trigger>::SharedPtr land_;
  rclcpp::TimerBase::SharedPtr watch_;
};

}  // namespace
}  // namespace roscopter

ROSFLIGHT_NODE(roscopter::ControllerNode, SingleThreadedExecutor)
