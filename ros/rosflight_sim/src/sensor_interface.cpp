// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_sim/sensor_interface.hpp"

#include <string>

#include "rosflight_common/due.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosflight_sim {

using rosflight_common::Due;
using rosflight_common::newest;

namespace {

struct Sensor {
  const char* name;
  double usual_Hz;
};

constexpr std::array<Sensor, 7> kSensors{{{"imu", 400.0},
                                          {"mag", 50.0},
                                          {"baro", 100.0},
                                          {"gnss", 10.0},
                                          {"range", 20.0},
                                          {"diff_pressure", 100.0},
                                          {"battery", 200.0}}};
constexpr const char* kFrequency = "_update_frequency";

}  // namespace

struct SensorInterface::Outputs {
  template <class Message>
  using Topic = typename rclcpp::Publisher<Message>::SharedPtr;

  explicit Outputs(rclcpp::Node& node)
      : imu{open<sensor_msgs::msg::Imu>(node, "sim/sensors/imu/data")},
        temperature{open<sensor_msgs::msg::Temperature>(node, "sim/sensors/imu/temperature")},
        bias{open<sensor_msgs::msg::Imu>(node, "sim/truth_imu_bias")},
        mag{open<sensor_msgs::msg::MagneticField>(node, "sim/sensors/mag")},
        baro{open<rosflight_msgs::msg::Barometer>(node, "sim/sensors/baro")},
        gnss{open<rosflight_msgs::msg::GNSS>(node, "sim/sensors/gnss")},
        range{open<sensor_msgs::msg::Range>(node, "sim/sensors/range")},
        diff_pressure{open<rosflight_msgs::msg::Airspeed>(node, "sim/sensors/diff_pressure")},
        battery{open<rosflight_msgs::msg::BatteryStatus>(node, "sim/sensors/battery")} {}

  template <class Message>
  static Topic<Message> open(rclcpp::Node& node, const char* name) {
    return node.create_publisher<Message>(name, newest());
  }

  /// Under the stamp of this step.
  template <class Message>
  void send(const Topic<Message>& topic, Message message) const {
    message.header.stamp = stamp;
    topic->publish(message);
  }

  builtin_interfaces::msg::Time stamp;
  std::array<Due, kCount> due{Due{1.0}, Due{1.0}, Due{1.0}, Due{1.0}, Due{1.0}, Due{1.0}, Due{1.0}};
  Topic<sensor_msgs::msg::Imu> imu;
  Topic<sensor_msgs::msg::Temperature> temperature;
  Topic<sensor_msgs::msg::Imu> bias;
  Topic<sensor_msgs::msg::MagneticField> mag;
  Topic<rosflight_msgs::msg::Barometer> baro;
  Topic<rosflight_msgs::msg::GNSS> gnss;
  Topic<sensor_msgs::msg::Range> range;
  Topic<rosflight_msgs::msg::Airspeed> diff_pressure;
  Topic<rosflight_msgs::msg::BatteryStatus> battery;
};

SensorInterface::SensorInterface(const rclcpp::NodeOptions& options)
    : Node("sensors", options), outputs_{std::make_unique<Outputs>(*this)} {
  const auto set = [this](std::size_t sensor, double rate_Hz) {
    rates_Hz_[sensor] = rate_Hz;
    outputs_->due[sensor].set_rate(rate_Hz);
  };
  for (std::size_t k = 0; k < kCount; ++k)
    set(k, rosflight_common::declare_number(*this, std::string(kSensors[k].name) + kFrequency,
                                            kSensors[k].usual_Hz, 0.1, 2000.0,
                                            "samples per second [Hz]", true));
  parameter_callback_handle_ =
      rosflight_common::on_change(*this, [set](const rclcpp::Parameter& parameter) {
        for (std::size_t k = 0; k < kCount; ++k)
          if (parameter.get_name() == std::string(kSensors[k].name) + kFrequency)
            set(k, parameter.as_double());
      });
  using rosflight_msgs::msg::SimState;
  using rosflight_msgs::msg::Status;
  using Wind = geometry_msgs::msg::Vector3Stamped;
  using Wrench = geometry_msgs::msg::WrenchStamped;
  subscriptions_ = {
      create_subscription<Status>("status", newest(),
                                  [this](Status::ConstSharedPtr m) { status_ = *m; }),
      create_subscription<Wind>("sim/truth_wind", newest(),
                                [this](Wind::ConstSharedPtr m) { air_ = *m; }),
      create_subscription<Wrench>("sim/forces_and_moments", newest(),
                                  [this](Wrench::ConstSharedPtr m) { wrench_ = *m; }),
      create_subscription<SimState>("sim/truth_state", newest(),
                                    [this](SimState::ConstSharedPtr m) { measure(*m); })};
}

SensorInterface::~SensorInterface() = default;

void SensorInterface::measure(const rosflight_msgs::msg::SimState& state) {
  Outputs& out = *outputs_;
  out.stamp = state.header.stamp;
  const std::int64_t stamp_ns = rosflight_common::nanoseconds(out.stamp);
  const auto due = [&](Which sensor) { return out.due[sensor].at(stamp_ns); };
  if (due(kImu)) measure_imu(state);
  if (due(kMag)) out.send(out.mag, mag_update(state));
  if (due(kBaro)) out.send(out.baro, baro_update(state));
  if (due(kGnss)) out.send(out.gnss, gnss_update(state));
  if (due(kRange)) out.send(out.range, range_update(state));
  if (due(kDiffPressure)) out.send(out.diff_pressure, diff_pressure_update(state, air_));
  if (due(kBattery)) out.send(out.battery, battery_update(state));
}

void SensorInterface::measure_imu(const rosflight_msgs::msg::SimState& state) {
  outputs_->send(outputs_->temperature, imu_temperature_update(state));
  outputs_->send(outputs_->imu, imu_update(state, wrench_));
  outputs_->send(outputs_->bias, get_imu_biases());
}

}  // namespace rosflight_sim
