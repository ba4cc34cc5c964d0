// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <optional>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/pwm_output.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>

#include "messages/simulation.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/module_states.hpp"
#include "rosflight_sim/vehicle_tuning.hpp"
#include "sim/registry.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;
namespace hal = rosflight::hal;
namespace messages = rosflight::messages;
namespace {

using namespace rosflight_common;
using messages::from_message;

/// Forces and moments of the vehicle's module, one wrench for every message of pulses.
///
/// The module's own states (rotor speeds, charge) are integrated here, from the stamp of the last
/// pulses to that of these, with the newest truth and wind held. The wrench carries the stamp of
/// the pulses, so the dynamics' steps are the board's.
class ForcesNode : public rclcpp::Node {
 public:
  explicit ForcesNode(const rclcpp::NodeOptions& options)
      : Node("mav_forces_and_moments", options), parameters_{VehicleParameters::declare(*this)} {
    sim::register_physics(registry_);
    const auto plugins = declare_parameter<std::vector<std::string>>(
        "plugins", {}, described("shared libraries with forces-and-moments modules"));
    for (const auto& plugin : plugins)
      if (!plugin.empty()) registry_.load_plugin(plugin);
    const std::string& type = parameters_.vehicle.type();
    if (type == "multirotor" || type == "fixedwing") {
      tuning_.emplace(*this, type == "multirotor" ? multirotor_views() : fixedwing_views(),
                      parameters_, [this] { make_module(); });
    }
    make_module();
    wrench_ =
        create_publisher<geometry_msgs::msg::WrenchStamped>("sim/forces_and_moments", newest());
    battery_ = create_publisher<rosflight_msgs::msg::BatteryStatus>("sim/truth_battery", newest());
    truth_ = create_subscription<rosflight_msgs::msg::SimState>(
        "sim/truth_state", newest(), [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) {
          const double gravity = parameters_.vehicle.environment().gravity_m_s2;
          const auto state = from_ros<messages::rosflight_msgs::SimState>(*message);
          if (!from_message(state, gravity, now_)) refuse("sim/truth_state");
        });
    wind_ = create_subscription<geometry_msgs::msg::Vector3Stamped>(
        "sim/truth_wind", newest(),
        [this](geometry_msgs::msg::Vector3Stamped::ConstSharedPtr message) {
          const auto wind = from_ros<messages::geometry_msgs::Vector3Stamped>(*message);
          if (!from_message(wind, now_.air.wind_W)) refuse("sim/truth_wind");
        });
    pulses_ = create_subscription<rosflight_msgs::msg::PwmOutput>(
        "sim/pwm_output", newest(),
        [this](rosflight_msgs::msg::PwmOutput::ConstSharedPtr message) { answer(*message); });
  }

 private:
  /// The module from the vehicle; its states go on if they are as many as before.
  void make_module() {
    auto made = registry_.make_forces(parameters_.vehicle, parameters_.random);  // or throws
    std::vector<double> before;
    if (states_) before.assign(states_->states().begin(), states_->states().end());
    module_ = std::move(made);
    states_.emplace(*module_);
    if (states_->states().size() == before.size())
      std::copy(before.begin(), before.end(), states_->states().begin());
    atmosphere_ = sim::Atmosphere{parameters_.vehicle.environment().atmosphere};
    no_ground_ = parameters_.vehicle.ground().model == sim::GroundModel::kNone;
  }

  void refuse(const char* topic) {
    constexpr int kInterval_ms = 2000;
    RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms,
                         "%s: found numbers that are not finite or no rotation, not used", topic);
  }

  void answer(const rosflight_msgs::msg::PwmOutput& pulses) {
    hal::OutputValues outputs{};
    from_message(from_ros<messages::rosflight_msgs::PwmOutput>(pulses), outputs);
    const double height_m = parameters_.vehicle.environment().origin.altitude_m - now_.body.p_W.z();
    const auto air = atmosphere_.at(height_m);
    now_.air.density_kg_m3 = air.density_kg_m3;
    now_.air.pressure_Pa = air.pressure_Pa;
    now_.air.temperature_K = air.temperature_K;
    const sim::Matrix3 R_WB = now_.body.q_WB.toRotationMatrix();
    const sim::Vector3 v_air_B = now_.body.v_B - R_WB.transpose() * now_.air.wind_W;
    constexpr double kNoGround_m = 1e6;
    const sim::ForcesAndMoments::Input in{
        now_.body, R_WB, v_air_B, now_.air, outputs, no_ground_ ? kNoGround_m : -now_.body.p_W.z()};
    const std::int64_t stamp = nanoseconds(pulses.header.stamp);
    sim::Wrench wrench;
    states_->step(in, static_cast<double>(stamp - last_stamp_) * 1e-9, wrench, now_);
    last_stamp_ = stamp;
    publish(pulses.header.stamp, wrench);
  }

  void publish(const builtin_interfaces::msg::Time& stamp, const sim::Wrench& wrench) {
    auto message = to_ros<geometry_msgs::msg::WrenchStamped>(messages::to_message(wrench));
    message.header.stamp = stamp;
    message.header.frame_id = "aircraft_body";
    wrench_->publish(message);
    constexpr int kBatteryEvery = 2;  // 200 Hz, as the battery's sensor
    if (++wrenches_ % kBatteryEvery != 0) return;
    rosflight_msgs::msg::BatteryStatus battery;
    battery.header.stamp = stamp;
    battery.voltage = static_cast<float>(now_.battery_voltage_V);
    battery.current = static_cast<float>(now_.battery_current_A);
    battery_->publish(battery);
  }

  VehicleParameters parameters_;
  std::optional<VehicleTuning> tuning_;
  sim::Registry registry_;
  std::unique_ptr<sim::ForcesAndMoments> module_;
  std::optional<ModuleStates> states_;
  sim::Atmosphere atmosphere_;
  bool no_ground_{};
  sim::Truth now_;
  std::int64_t last_stamp_{0};
  std::uint64_t wrenches_{0};
  rclcpp::Publisher<geometry_msgs::msg::WrenchStamped>::SharedPtr wrench_;
  rclcpp::Publisher<rosflight_msgs::msg::BatteryStatus>::SharedPtr battery_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truth_;
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr wind_;
  rclcpp::Subscription<rosflight_msgs::msg::PwmOutput>::SharedPtr pulses_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::ForcesNode, SingleThreadedExecutor)
