// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <rclcpp/rclcpp.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/status.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "rosflight_common/due.hpp"
#include "rosflight_common/param_manager.hpp"

namespace rosflight_common {

/// Measurements for an estimator, under the names of ROSflight 2.x. Body axes front-right-down; zero until the first message.
struct EstimatorInput {
  float gyro_x{}, gyro_y{}, gyro_z{};     ///< [rad/s]
  float accel_x{}, accel_y{}, accel_z{};  ///< Specific force [m/s^2].
  bool baro_new{};
  float static_pres{};  ///< Reference pressure minus the present one [Pa]: rises with altitude.
  bool diff_new{};
  float diff_pres{};  ///< [Pa]
  bool gps_new{};
  int gps_yday{}, gps_year{}, gps_month{}, gps_day{};  ///< UTC; yday and month count from 0.
  double gps_lat{}, gps_lon{}, gps_alt{};              ///< [deg], [deg], [m MSL]
  float gps_n{}, gps_e{}, gps_h{};               ///< North, east and up from the first fix [m].
  float gps_vg{}, gps_vn{}, gps_ve{}, gps_vd{};  ///< Ground speed; north, east, down [m/s].
  float gps_course{};                            ///< [rad]; held below gps_ground_speed_threshold.
  bool status_armed{}, armed_init{};             ///< Armed now; has been armed once.
  bool mag_new{};
  float mag_x{}, mag_y{}, mag_z{};  ///< [T]
};

/// An estimate, under the names of ROSflight 2.x: position in NED [m], velocity and rates in body axes [m/s, rad/s], angles
/// [rad], gyro bias [rad/s], attitude body to NED.
struct EstimatorOutput {
  float pn{}, pe{}, pd{};
  float vx{}, vy{}, vz{};
  float phi{}, theta{}, psi{};
  float bx{}, by{}, bz{};
  float p{}, q{}, r{};
  Eigen::Quaternionf quat{1.0F, 0.0F, 0.0F, 0.0F};
};

/// Sensors, origin and barometer of an estimator: all of it but the filter.
///
/// From the first arming on, step() runs with the IMU, at most estimator_update_frequency times a second. GNSS is used from
/// min_gnss_fix_type on; the first fix is the origin. The reference pressure is the mean of baro_calibration_count samples from
/// the first arming on; it is taken again if one of them lies more than two interquartile ranges outside the quartiles. Later
/// samples change by at most baro_measurement_gate [m]. Compiles as C++17.
class EstimatorInterface : public rclcpp::Node {
 protected:
  using Input = EstimatorInput;

  explicit EstimatorInterface(const rclcpp::NodeOptions& options);

  /// Warns, at most once a second, of each sensor that is silent for longer than max_NAME_sensor_silence_duration_ms.
  void check_sensors();
  void set_sensor_monitoring();

  /// Restarts the silence of a sensor.
  void received(const std::string& sensor) { time_since_last_sensor_update_[sensor] = now(); }
  Input& input() { return input_; }

  ParamManager params_{this};
  bool parameter_changed{false};  ///< Set by each change of a parameter; a derived class clears it.
  bool baro_init_{false};
  bool mag_init_{false};  ///< For the derived class.
  bool gps_init_{false};
  bool has_fix_{false};
  float rho_{0.0F};  ///< The parameter, else standard air at the altitude of the origin [kg/m^3].
  double init_lat_{0.0};     ///< [deg]
  double init_lon_{0.0};     ///< [deg]
  float init_alt_{0.0F};     ///< [m MSL]
  float init_static_{0.0F};  ///< [Pa]
  std::unordered_map<std::string, rclcpp::Time> time_since_last_sensor_update_;

 private:
  /// Estimates and publishes.
  virtual void step(const builtin_interfaces::msg::Time& stamp, const Input& input) = 0;

  void declare();
  template <class Message>
  void subscribe(const char* topic, const rclcpp::QoS& qos);

  void take(const rosflight_msgs::msg::Status& message);
  void take(const sensor_msgs::msg::Imu& message);
  void take(const sensor_msgs::msg::MagneticField& message);
  void take(const rosflight_msgs::msg::GNSS& message);
  void take(const rosflight_msgs::msg::Barometer& message);
  void set_origin(const rosflight_msgs::msg::GNSS& fix);
  void set_date(const rosflight_msgs::msg::GNSS& fix);
  void calibrate(float pressure_Pa);

  Input input_;
  Due update_;
  std::vector<float> pressures_;
  ParamManager::Handle rate_handle_;
  ParamManager::Handle handle_;
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
};

/// An EstimatorInterface that calls estimate() and publishes on `estimated_state`, under the stamp of the IMU sample.
template <class Message, class Result>
class StateEstimator : public EstimatorInterface {
 protected:
  using Output = Result;

  explicit StateEstimator(const rclcpp::NodeOptions& options)
      : EstimatorInterface(options),
        states_{create_publisher<Message>("estimated_state", rclcpp::QoS(10))} {}

 private:
  /// One step of the filter. `output` has the values of the step before.
  virtual void estimate(const Input& input, Output& output) = 0;
  /// The fields of the state that EstimatorOutput does not have.
  virtual void fill_more(const Output& /*output*/, Message& /*message*/) const {}

  void step(const builtin_interfaces::msg::Time& stamp, const Input& input) override {
    estimate(input, output_);
    Message state;
    state.header.stamp = stamp;
    state.initial_lat = init_lat_;
    state.initial_lon = init_lon_;
    state.initial_alt = static_cast<double>(init_alt_);
    state.p_n = output_.pn, state.p_e = output_.pe, state.p_d = output_.pd;
    state.v_x = output_.vx, state.v_y = output_.vy, state.v_z = output_.vz;
    state.phi = output_.phi, state.theta = output_.theta, state.psi = output_.psi;
    state.p = output_.p, state.q = output_.q, state.r = output_.r;
    state.b_x = output_.bx, state.b_y = output_.by, state.b_z = output_.bz;
    const Eigen::Quaterniond quat = output_.quat.template cast<double>();
    state.quat.w = quat.w(), state.quat.x = quat.x();
    state.quat.y = quat.y(), state.quat.z = quat.z();
    fill_more(output_, state);
    states_->publish(state);
  }

  Output output_;
  typename rclcpp::Publisher<Message>::SharedPtr states_;
};

}  // namespace rosflight_common
