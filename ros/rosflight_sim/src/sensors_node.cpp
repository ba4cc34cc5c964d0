// SPDX-License-Identifier: BSD-3-Clause
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>

#include "messages/simulation.hpp"
#include "rosflight_common/component.hpp"
#include "rosflight_common/live_parameters.hpp"
#include "rosflight_common/messages.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"
#include "rosflight_sim/sensor_parameters.hpp"
#include "rosflight_sim/tick_tracker.hpp"
#include "rosflight_sim/vehicle_parameters.hpp"
#include "rosflight_sim/world_topics.hpp"
#include "sim/sensors/read_config.hpp"
#include "sim/sensors/register.hpp"
#include "sim/sensors/standard_sensors.hpp"

namespace rosflight_sim {

namespace sim = rosflight::sim;
namespace hal = rosflight::hal;
namespace messages = rosflight::messages;
namespace {

using namespace rosflight_common;
using messages::from_message;

/// Instruments in simulated time, fed with the truth of another node: one step of the sensors
/// module at every message of truth. Samples carry the stamp of the truth they measured.
class SensorsNode : public rclcpp::Node {
 public:
  explicit SensorsNode(const rclcpp::NodeOptions& options)
      : Node("sensors", options), parameters_{VehicleParameters::declare(*this)} {
    const double rate_Hz = declare_number(*this, "truth_rate", 400.0, 50.0, 2000.0,
                                          "rate of sim/truth_state the instruments expect [Hz]");
    ticks_.emplace(static_cast<std::int64_t>(1e9 / rate_Hz));
    frame_ = declare_text(*this, "frame_id", "aircraft_body", "frame of the samples");
    choose_rates();
    sim::register_physics(registry_);
    sim::sensors::register_sensors(registry_);
    sim::register_world_sensors(registry_);
    load_plugins();
    environment_ = parameters_.vehicle.environment();
    module_ = sim::sensors::make_sensors(registry_, parameters_.vehicle, parameters_.random);
    if (dynamic_cast<const sim::sensors::StandardSensors*>(module_.get()) != nullptr)
      declare_instruments();
    set_up_truth();
    const auto step_us = static_cast<std::int64_t>(1e6 / rate_Hz);
    world_.emplace(*this, registry_, parameters_, sim::Time{step_us});
    open_topics();
  }

 private:
  void load_plugins() {
    const auto plugins = declare_parameter<std::vector<std::string>>(
        "plugins", {}, described("shared libraries with sensors of the world"));
    for (const auto& plugin : plugins)
      if (!plugin.empty()) registry_.load_plugin(plugin);
  }

  void choose_rates() {
    const std::string rates = declare_text(*this, "sensor_rates", "rosflight_2",
                                           "rosflight_2: those of ROSflight 2.x where the vehicle "
                                           "file gives none; vehicle: as the vehicle file says");
    if (rates != "rosflight_2" && rates != "vehicle") {
      throw rosflight::config::Error("parameter sensor_rates: found '" + rates +
                                     "', allowed rosflight_2 or vehicle");
    }
    if (rates == "rosflight_2") parameters_.make(rosflight_rates(parameters_.vehicle.sensors()));
  }

  /// The parameters of ROSflight 2.x, with what the vehicle file says as their defaults.
  void declare_instruments() {
    settings_ = {sim::sensors::read_sensors(parameters_.vehicle.sensors()), environment_};
    tuning_.emplace(*this, sensor_parameters(), settings_, parameters_.values_for(get_name()));
    parameters_.log_unused(*this);
    make_instruments(settings_);
    tuning_->on_change([this](const SensorSettings& wanted) {
      make_instruments(wanted);
      return "";
    });
  }

  void make_instruments(const SensorSettings& settings) {
    environment_ = settings.environment;
    auto made = std::make_unique<sim::sensors::StandardSensors>(settings.sensors, environment_,
                                                                parameters_.random);
    standard_ = made.get();
    module_ = std::move(made);
  }

  /// Until the nodes that know better have spoken.
  void set_up_truth() {
    constexpr double kSomeVoltage_V = 23.0;  // that of the simulator of ROSflight 2.x
    truth_.battery_voltage_V = kSomeVoltage_V;
    truth_.battery_current_A = 1.0;
    atmosphere_ = sim::Atmosphere{environment_.atmosphere};
  }

  void open_topics() {
    imu_ = create_publisher<sensor_msgs::msg::Imu>("sim/sensors/imu/data", newest());
    temperature_ =
        create_publisher<sensor_msgs::msg::Temperature>("sim/sensors/imu/temperature", newest());
    bias_ = create_publisher<sensor_msgs::msg::Imu>("sim/truth_imu_bias", newest());
    mag_ = create_publisher<sensor_msgs::msg::MagneticField>("sim/sensors/mag", newest());
    baro_ = create_publisher<rosflight_msgs::msg::Barometer>("sim/sensors/baro", newest());
    gnss_ = create_publisher<rosflight_msgs::msg::GNSS>("sim/sensors/gnss", newest());
    pitot_ = create_publisher<rosflight_msgs::msg::Airspeed>("sim/sensors/diff_pressure", newest());
    range_ = create_publisher<sensor_msgs::msg::Range>("sim/sensors/range", newest());
    battery_ =
        create_publisher<rosflight_msgs::msg::BatteryStatus>("sim/sensors/battery", newest());
    winds_ = create_subscription<geometry_msgs::msg::Vector3Stamped>(
        "sim/truth_wind", newest(),
        [this](geometry_msgs::msg::Vector3Stamped::ConstSharedPtr message) {
          from_message(from_ros<messages::geometry_msgs::Vector3Stamped>(*message),
                       truth_.air.wind_W);
        });
    batteries_ = create_subscription<rosflight_msgs::msg::BatteryStatus>(
        "sim/truth_battery", newest(),
        [this](rosflight_msgs::msg::BatteryStatus::ConstSharedPtr message) {
          truth_.battery_voltage_V = static_cast<double>(message->voltage);
          truth_.battery_current_A = static_cast<double>(message->current);
        });
    truths_ = create_subscription<rosflight_msgs::msg::SimState>(
        "sim/truth_state", newest(),
        [this](rosflight_msgs::msg::SimState::ConstSharedPtr message) { step(*message); });
  }

  void step(const rosflight_msgs::msg::SimState& message) {
    if (!from_message(from_ros<messages::rosflight_msgs::SimState>(message),
                      environment_.gravity_m_s2, truth_)) {
      constexpr int kInterval_ms = 2000;
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms,
                           "sim/truth_state: found numbers that are not finite or no rotation, "
                           "not used");
      return;
    }
    stamp_ns_ = nanoseconds(message.header.stamp);
    if (!ticks_->step(stamp_ns_)) return;
    truth_.time = ticks_->time();
    const double height_m = environment_.origin.altitude_m - truth_.body.p_W.z();
    const auto air = atmosphere_.at(height_m);
    truth_.air.density_kg_m3 = air.density_kg_m3;
    truth_.air.pressure_Pa = air.pressure_Pa;
    truth_.air.temperature_K = air.temperature_K;
    module_->step(truth_, samples_);
    publish_imu();
    send(samples_.has_mag, samples_.mag, *mag_);
    send(samples_.has_baro, samples_.baro, *baro_);
    send(samples_.has_gnss, samples_.gnss, *gnss_);
    send(samples_.has_diff_pressure, samples_.diff_pressure, *pitot_);
    send(samples_.has_range, samples_.range, *range_);
    send(samples_.has_battery, samples_.battery, *battery_);
    world_->step(truth_, stamp_ns_);
  }

  /// Stamp and frame of a sample that was measured some time before this step.
  template <class Sample>
  std_msgs::msg::Header header(const Sample& sample) const {
    constexpr std::int64_t kMicrosecond_ns = 1000;
    std_msgs::msg::Header header;
    header.stamp = stamp_of(stamp_ns_ - (truth_.time - sample.stamp).count() * kMicrosecond_ns);
    header.frame_id = frame_;
    return header;
  }

  template <class Sample, class Message>
  void send(bool there, const Sample& sample, rclcpp::Publisher<Message>& publisher) {
    if (!there) return;
    auto message = to_ros<Message>(messages::to_message(sample));
    message.header = header(sample);
    publisher.publish(message);
  }

  void publish_imu() {
    if (!samples_.has_imu) return;
    const hal::ImuSample& s = samples_.imu;
    auto imu = to_ros<sensor_msgs::msg::Imu>(messages::to_message(s));
    imu.header = header(samples_.imu);
    constexpr std::uint64_t kTemperatureEvery = 10;  // it changes in minutes
    if (imus_++ % kTemperatureEvery == 0) {
      auto temperature = to_ros<sensor_msgs::msg::Temperature>(messages::imu_temperature(s));
      temperature.header = imu.header;
      temperature_->publish(temperature);
    }
    imu_->publish(imu);
    if (standard_ == nullptr) return;
    auto bias = to_ros<sensor_msgs::msg::Imu>(
        messages::imu_message(standard_->accel_bias(), standard_->gyro_bias()));
    bias.header = imu.header;
    bias_->publish(bias);
  }

  VehicleParameters parameters_;
  sim::Registry registry_;
  std::unique_ptr<sim::SensorsModule> module_;
  const sim::sensors::StandardSensors* standard_{nullptr};
  std::optional<WorldTopics> world_;
  sim::EnvironmentParameters environment_;
  SensorSettings settings_;  ///< Settings of the module `standard`.
  std::optional<rosflight_common::LiveParameters<SensorSettings>> tuning_;
  sim::Atmosphere atmosphere_;
  std::optional<TickTracker> ticks_;
  std::string frame_;
  sim::Truth truth_;
  std::int64_t stamp_ns_{0};
  std::uint64_t imus_{0};
  sim::SensorSamples samples_;
  rclcpp::Publisher<sensor_msgs::msg::Imu>::SharedPtr imu_, bias_;
  rclcpp::Publisher<sensor_msgs::msg::Temperature>::SharedPtr temperature_;
  rclcpp::Publisher<sensor_msgs::msg::MagneticField>::SharedPtr mag_;
  rclcpp::Publisher<rosflight_msgs::msg::Barometer>::SharedPtr baro_;
  rclcpp::Publisher<rosflight_msgs::msg::GNSS>::SharedPtr gnss_;
  rclcpp::Publisher<rosflight_msgs::msg::Airspeed>::SharedPtr pitot_;
  rclcpp::Publisher<sensor_msgs::msg::Range>::SharedPtr range_;
  rclcpp::Publisher<rosflight_msgs::msg::BatteryStatus>::SharedPtr battery_;
  rclcpp::Subscription<geometry_msgs::msg::Vector3Stamped>::SharedPtr winds_;
  rclcpp::Subscription<rosflight_msgs::msg::BatteryStatus>::SharedPtr batteries_;
  rclcpp::Subscription<rosflight_msgs::msg::SimState>::SharedPtr truths_;
};

}  // namespace
}  // namespace rosflight_sim

ROSFLIGHT_NODE(rosflight_sim::SensorsNode, SingleThreadedExecutor)
