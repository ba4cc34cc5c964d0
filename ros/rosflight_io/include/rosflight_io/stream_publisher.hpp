// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <geometry_msgs/msg/vector3_stamped.hpp>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/attitude.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/error.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/output_raw.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>
#include <string>

#include "companion/listener.hpp"
#include "rosflight_io/clock.hpp"

namespace rosflight_io {

namespace link = rosflight::link;

/// Every stream of the link as a topic. Reliable, volatile, depth 1000; a topic appears with its first
/// message, so a missing topic is a missing sensor. Called by the link's thread.
class StreamPublisher final : public rosflight::companion::Listener {
 public:
  using Stamp = rosflight::companion::Stamp;

  /// @param frame_id  of IMU, its temperature and the magnetometer.
  StreamPublisher(rclcpp::Node& node, Clock& clock, std::string frame_id);

  void on_imu(const link::Imu& m, const Stamp& stamp) override;
  void on_attitude(const link::Attitude& m, const Stamp& stamp) override;
  void on_mag(const link::Mag& m, const Stamp& stamp) override;
  void on_baro(const link::Baro& m, const Stamp& stamp) override;
  void on_diff_pressure(const link::DiffPressure& m, const Stamp& stamp) override;
  void on_range(const link::Range& m, const Stamp& stamp) override;
  void on_rc(const link::RcChannels& m, const Stamp& stamp) override;
  void on_output(const link::OutputRaw& m, const Stamp& stamp) override;
  void on_gnss(const link::Gnss& m, const Stamp& stamp) override;
  void on_battery(const link::BatteryStatus& m, const Stamp& stamp) override;
  void on_status(const link::Status& m, const Stamp& stamp) override;
  void on_event(const rosflight::companion::Event& event) override;

 private:
  template <class Ros>
  struct Topic {
    const char* name;
    typename rclcpp::Publisher<Ros>::SharedPtr publisher{};
  };

  template <class Ros, class Message>
  void publish(Topic<Ros>& topic, const Message& message, rosflight::companion::Time t,
               const std::string& frame_id = {});

  rclcpp::Node& node_;
  Clock& clock_;
  std::string frame_id_;

  Topic<sensor_msgs::msg::Imu> imu_{"imu/data"};
  Topic<sensor_msgs::msg::Temperature> temperature_{"imu/temperature"};
  Topic<rosflight_msgs::msg::Attitude> attitude_topic_{"attitude"};
  Topic<geometry_msgs::msg::Vector3Stamped> euler_{"attitude/euler"};
  Topic<sensor_msgs::msg::MagneticField> mag_{"magnetometer"};
  Topic<rosflight_msgs::msg::Barometer> baro_{"baro"};
  Topic<rosflight_msgs::msg::Airspeed> airspeed_{"airspeed"};
  Topic<sensor_msgs::msg::Range> range_{"range"};
  Topic<rosflight_msgs::msg::RCRaw> rc_{"rc_raw"};
  Topic<rosflight_msgs::msg::OutputRaw> output_{"output_raw"};
  Topic<rosflight_msgs::msg::GNSS> gnss_{"gnss"};
  Topic<rosflight_msgs::msg::BatteryStatus> battery_{"battery"};
  Topic<rosflight_msgs::msg::Status> status_{"status"};
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr version_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr unsaved_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr params_changed_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr restarted_;
  rclcpp::Publisher<rosflight_msgs::msg::Error>::SharedPtr errors_;
  std::optional<link::Attitude> attitude_;  ///< The latest.
  bool list_complete_{false};
};

}  // namespace rosflight_io
