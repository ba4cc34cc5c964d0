// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>
#include <vector>

namespace rosflight_sim {

/// Base class for sensors of your own: node `sensors`, in place of standalone_sensors (launch argument sensors:=false). The names are
/// those of ROSflight 2.x.
///
/// With each `sim/truth_state` it calls the functions of the sensors that are due by their *_update_frequency, and publishes the
/// samples under the stamp of the truth that they measured, on `sim/sensors/*` and `sim/truth_imu_bias`. Units and axes are those of the messages:
/// SI, body axes front-right-down. Compiles as C++17.
class SensorInterface : public rclcpp::Node {
 public:
  explicit SensorInterface(const rclcpp::NodeOptions& options = rclcpp::NodeOptions());
  ~SensorInterface() override;

 protected:
  float get_imu_update_frequency() const { return rate(kImu); }
  float get_mag_update_frequency() const { return rate(kMag); }
  float get_baro_update_frequency() const { return rate(kBaro); }
  float get_gnss_update_frequency() const { return rate(kGnss); }
  float get_range_update_frequency() const { return rate(kRange); }
  float get_diff_pressure_update_frequency() const { return rate(kDiffPressure); }
  float get_battery_update_frequency() const { return rate(kBattery); }

  /// The newest status of the flight controller.
  rosflight_msgs::msg::Status get_current_status() const { return status_; }

 private:
  enum Which : std::uint8_t { kImu, kMag, kBaro, kGnss, kRange, kDiffPressure, kBattery, kCount };
  struct Outputs;

  /// @param forces  the newest wrench: force over mass is the specific force at the centre of mass.
  virtual sensor_msgs::msg::Imu imu_update(const rosflight_msgs::msg::SimState& state,
                                           const geometry_msgs::msg::WrenchStamped& forces) = 0;
  virtual sensor_msgs::msg::Temperature imu_temperature_update(
      const rosflight_msgs::msg::SimState& state) = 0;
  virtual sensor_msgs::msg::Imu get_imu_biases() = 0;
  virtual sensor_msgs::msg::MagneticField mag_update(
      const rosflight_msgs::msg::SimState& state) = 0;
  virtual rosflight_msgs::msg::Barometer baro_update(
      const rosflight_msgs::msg::SimState& state) = 0;
  virtual rosflight_msgs::msg::GNSS gnss_update(const rosflight_msgs::msg::SimState& state) = 0;
  virtual sensor_msgs::msg::Range range_update(const rosflight_msgs::msg::SimState& state) = 0;
  virtual rosflight_msgs::msg::Airspeed diff_pressure_update(
      const rosflight_msgs::msg::SimState& state,
      const geometry_msgs::msg::Vector3Stamped& wind) = 0;
  virtual rosflight_msgs::msg::BatteryStatus battery_update(
      const rosflight_msgs::msg::SimState& state) = 0;

  float rate(Which sensor) const { return static_cast<float>(rates_Hz_[sensor]); }
  void measure(const rosflight_msgs::msg::SimState& state);
  void measure_imu(const rosflight_msgs::msg::SimState& state);

  std::array<double, kCount> rates_Hz_{};
  std::unique_ptr<Outputs> outputs_;
  rosflight_msgs::msg::Status status_;
  geometry_msgs::msg::Vector3Stamped air_;
  geometry_msgs::msg::WrenchStamped wrench_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  OnSetParametersCallbackHandle::SharedPtr parameter_callback_handle_;
};

}  // namespace rosflight_sim
