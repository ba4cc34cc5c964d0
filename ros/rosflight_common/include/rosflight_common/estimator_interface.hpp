// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <functional>
#include <limits>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "rosflight_common/due.hpp"
#include "rosflight_common/param_manager.hpp"
#include "rosflight_common/time.hpp"

namespace rosflight_common {

/// What an estimator is given, under the names of ROSflight 2.x. Body axes front-right-down; what has not arrived is zero.
struct EstimatorInput {
  float gyro_x{}, gyro_y{}, gyro_z{};     ///< [rad/s]
  float accel_x{}, accel_y{}, accel_z{};  ///< Specific force [m/s^2].
  bool baro_new{};
  float static_pres{};  ///< Pressure of the calibration less that of now [Pa]: rises with height.
  bool diff_new{};
  float diff_pres{};  ///< [Pa]
  bool gps_new{};
  int gps_yday{}, gps_year{}, gps_month{}, gps_day{};  ///< UTC; yday and month count from 0.
  double gps_lat{}, gps_lon{}, gps_alt{};              ///< [deg], [deg], [m MSL]
  float gps_n{}, gps_e{}, gps_h{};               ///< North, east and height from the first fix [m].
  float gps_vg{}, gps_vn{}, gps_ve{}, gps_vd{};  ///< Ground speed; north, east, down [m/s].
  float gps_course{};                            ///< [rad]; held below gps_ground_speed_threshold.
  bool status_armed{}, armed_init{};             ///< Armed now; was armed once.
  bool mag_new{};
  float mag_x{}, mag_y{}, mag_z{};  ///< [T]
};

/// Sensors, origin and barometer of an estimator: everything of it that is no filter. The base of roscopter::EstimatorROS and
/// rosplane::EstimatorROS.
///
/// From the first arming on estimate() runs with the IMU, at most estimator_update_frequency times a second, and what it returns is
/// published under the stamp of the IMU sample. Before that nothing goes out. GNSS counts from min_gnss_fix_type on; the first fix
/// is the origin. The barometer's reference is the mean of baro_calibration_count samples from the first arming on, taken again if
/// one of them lies more than two interquartile ranges outside the quartiles. Compiles as C++17.
template <class Message, class Output>
class EstimatorInterface : public rclcpp::Node {
 protected:
  using Input = EstimatorInput;

  explicit EstimatorInterface(const rclcpp::NodeOptions& options)
      : Node("estimator", options), params_{this} {
    declare();
    update_.set_rate(params_.get_double("estimator_update_frequency"));
    handle_ = params_.watch([this] {
      parameter_changed = true;
      update_.set_rate(std::max(1.0, params_.get_double("estimator_update_frequency")));
    });
    set_sensor_monitoring();
    states_ = create_publisher<Message>("estimated_state", rclcpp::QoS(10));
    listen();
  }

  /// One step of the filter.
  virtual void estimate(const Input& input, Output& output) = 0;
  /// All of a state but header and origin.
  virtual void fill(const Output& output, Message& message) const = 0;
  /// Of the air at an altitude above mean sea level [m], [kg/m^3].
  virtual float standard_density(float altitude_m) const = 0;

  /// Warns, at most once a second each, of sensors that are silent for longer than max_NAME_sensor_silence_duration_ms.
  void check_sensors() {
    constexpr int kAgain_ms = 1000;
    for (const auto& [name, received] : time_since_last_sensor_update_) {
      const auto allowed_ms = params_.get_int("max_" + name + "_sensor_silence_duration_ms");
      const double silent_ms = 1e3 * (now() - received).seconds();
      if (silent_ms > static_cast<double>(allowed_ms))
        RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kAgain_ms,
                             "%s: silent for %.0f ms, allowed %ld ms", name.c_str(), silent_ms,
                             static_cast<long>(allowed_ms));
    }
  }
  void set_sensor_monitoring() {
    for (const char* name : {"imu", "mag", "baro", "gnss"}) heard(name);
  }

  /// A sensor of a derived class.
  void heard(const std::string& sensor) { time_since_last_sensor_update_[sensor] = now(); }
  Input& input() { return input_; }

  ParamManager params_;
  bool parameter_changed{
      false};  ///< Set by every change of a parameter; the derived class clears it.
  bool baro_init_{false};
  bool mag_init_{false};  ///< The derived class's.
  bool gps_init_{false};
  bool has_fix_{false};
  float rho_{0.0F};  ///< The parameter, else of the standard atmosphere at the origin [kg/m^3].
  double init_lat_{0.0};     ///< [deg]
  double init_lon_{0.0};     ///< [deg]
  float init_alt_{0.0F};     ///< [m MSL]
  float init_static_{0.0F};  ///< [Pa]
  std::unordered_map<std::string, rclcpp::Time> time_since_last_sensor_update_;

 private:
  static constexpr double kNotInUse = -1000000.0;
  static constexpr double kEarth_m = 6378145.0;

  void declare() {
    params_.declare_double("estimator_update_frequency", 390.0);
    params_.declare_double("rho", kNotInUse);
    params_.declare_double("gravity", 9.81);
    params_.declare_double("gps_ground_speed_threshold", 0.3);
    params_.declare_double("baro_measurement_gate", 1.35);
    params_.declare_int("baro_calibration_count", 100);
    params_.declare_int("max_imu_sensor_silence_duration_ms", 4);
    params_.declare_int("max_mag_sensor_silence_duration_ms", 25);
    params_.declare_int("max_baro_sensor_silence_duration_ms", 15);
    params_.declare_int("max_gnss_sensor_silence_duration_ms", 110);
    params_.declare_int("min_gnss_fix_type", 3);
    params_.declare_bool("hotstart_estimator", false);
    if (params_.get_bool("hotstart_estimator"))
      throw std::runtime_error(
          "parameter hotstart_estimator: found true, allowed false, because there is no hotstart "
          "file");
  }

  template <class Kind, class Take>
  void subscribe(const char* topic, Take take) {
    subscriptions_.push_back(create_subscription<Kind>(
        topic, rclcpp::QoS(10), [take](typename Kind::ConstSharedPtr message) { take(*message); }));
  }

  void listen() {
    subscribe<rosflight_msgs::msg::Status>("status",
                                           [this](const rosflight_msgs::msg::Status& message) {
                                             input_.status_armed = message.armed;
                                             input_.armed_init = input_.armed_init || message.armed;
                                           });
    subscribe<sensor_msgs::msg::Imu>("imu/data",
                                     [this](const sensor_msgs::msg::Imu& m) { take(m); });
    subscribe<rosflight_msgs::msg::GNSS>("gnss",
                                         [this](const rosflight_msgs::msg::GNSS& m) { take(m); });
    subscribe<rosflight_msgs::msg::Barometer>(
        "baro", [this](const rosflight_msgs::msg::Barometer& m) { take(m); });
    subscribe<sensor_msgs::msg::MagneticField>(
        "magnetometer", [this](const sensor_msgs::msg::MagneticField& message) {
          heard("mag");
          input_.mag_new = true;
          input_.mag_x = static_cast<float>(message.magnetic_field.x);
          input_.mag_y = static_cast<float>(message.magnetic_field.y);
          input_.mag_z = static_cast<float>(message.magnetic_field.z);
        });
  }

  void take(const sensor_msgs::msg::Imu& message) {
    heard("imu");
    input_.accel_x = static_cast<float>(message.linear_acceleration.x);
    input_.accel_y = static_cast<float>(message.linear_acceleration.y);
    input_.accel_z = static_cast<float>(message.linear_acceleration.z);
    input_.gyro_x = static_cast<float>(message.angular_velocity.x);
    input_.gyro_y = static_cast<float>(message.angular_velocity.y);
    input_.gyro_z = static_cast<float>(message.angular_velocity.z);
    if (!input_.armed_init || !update_.at(nanoseconds(message.header.stamp))) return;
    estimate(input_, output_);
    input_.gps_new = input_.mag_new = input_.baro_new = input_.diff_new = false;
    Message state;
    state.header.stamp = message.header.stamp;
    fill(output_, state);
    state.initial_lat = init_lat_;
    state.initial_lon = init_lon_;
    state.initial_alt = static_cast<double>(init_alt_);
    states_->publish(state);
  }

  void take(const rosflight_msgs::msg::GNSS& message) {
    heard("gnss");
    has_fix_ = message.fix_type >= params_.get_int("min_gnss_fix_type") &&
               std::isfinite(message.lat) && std::isfinite(message.lon);
    if (!has_fix_) return;
    if (!gps_init_) {
      begin_at(message);
      return;
    }
    const double rad_per_deg = std::atan(1.0) / 45.0;
    input_.gps_lat = message.lat;
    input_.gps_lon = message.lon;
    input_.gps_alt = static_cast<double>(message.alt);
    input_.gps_n = static_cast<float>(kEarth_m * (message.lat - init_lat_) * rad_per_deg);
    input_.gps_e = static_cast<float>(kEarth_m * std::cos(init_lat_ * rad_per_deg) *
                                      (message.lon - init_lon_) * rad_per_deg);
    input_.gps_h = message.alt - init_alt_;
    input_.gps_vn = message.vel_n;
    input_.gps_ve = message.vel_e;
    input_.gps_vd = message.vel_d;
    input_.gps_vg = std::hypot(message.vel_n, message.vel_e);
    if (static_cast<double>(input_.gps_vg) > params_.get_double("gps_ground_speed_threshold"))
      input_.gps_course = std::atan2(message.vel_e, message.vel_n);
    date(message);
    input_.gps_new = true;
  }

  /// The first fix: origin and density of the air.
  void begin_at(const rosflight_msgs::msg::GNSS& fix) {
    gps_init_ = true;
    init_lat_ = fix.lat;
    init_lon_ = fix.lon;
    init_alt_ = fix.alt;
    const auto given = static_cast<float>(params_.get_double("rho"));
    rho_ = given > 0.0F ? given : standard_density(init_alt_);
  }

  void date(const rosflight_msgs::msg::GNSS& fix) {
    const std::time_t time =
        fix.gnss_unix_seconds != 0 ? fix.gnss_unix_seconds : fix.header.stamp.sec;
    std::tm utc{};
    if (::gmtime_r(&time, &utc) == nullptr) return;
    constexpr int kFirstYear = 1900;
    input_.gps_yday = utc.tm_yday;
    input_.gps_year = utc.tm_year + kFirstYear;
    input_.gps_month = utc.tm_mon;
    input_.gps_day = utc.tm_mday;
  }

  void take(const rosflight_msgs::msg::Barometer& message) {
    heard("baro");
    if (!baro_init_) {
      if (input_.armed_init) calibrate(message.pressure);
      return;
    }
    input_.baro_new = true;
    const auto gate_Pa =
        static_cast<float>(params_.get_double("baro_measurement_gate") * static_cast<double>(rho_) *
                           params_.get_double("gravity"));
    if (!gps_init_) {  // without density no gate
      input_.static_pres = init_static_ - message.pressure;
      return;
    }
    input_.static_pres = std::clamp(init_static_ - message.pressure, input_.static_pres - gate_Pa,
                                    input_.static_pres + gate_Pa);
  }

  void calibrate(float pressure_Pa) {
    pressures_.push_back(pressure_Pa);
    const auto wanted = static_cast<std::size_t>(
        std::max<std::int64_t>(4, params_.get_int("baro_calibration_count")));
    if (pressures_.size() < wanted) return;
    std::sort(pressures_.begin(), pressures_.end());
    const float low = pressures_[wanted / 4];
    const float high = pressures_[3 * wanted / 4];
    const float margin = 2.0F * (high - low);
    const bool good = pressures_.front() >= low - margin && pressures_.back() <= high + margin;
    double sum = 0.0;
    for (const float pressure : pressures_) sum += static_cast<double>(pressure);
    init_static_ = static_cast<float>(sum / static_cast<double>(wanted));
    baro_init_ = good;
    pressures_.clear();
    if (!good)
      RCLCPP_WARN(get_logger(), "baro: found a sample far from the others, calibrated again");
  }

  Input input_;
  Output output_;
  Due update_{390.0};
  std::vector<float> pressures_;
  ParamManager::Handle handle_;
  typename rclcpp::Publisher<Message>::SharedPtr states_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
};

}  // namespace rosflight_common
