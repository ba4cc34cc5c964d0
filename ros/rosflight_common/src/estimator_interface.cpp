// SPDX-License-Identifier: BSD-3-Clause
#include "rosflight_common/estimator_interface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <stdexcept>

#include "base/atmosphere.hpp"
#include "base/constants.hpp"
#include "rosflight_common/node_tools.hpp"
#include "rosflight_common/time.hpp"

namespace rosflight_common {
namespace {

namespace base = rosflight::base;

constexpr std::size_t kDepth = 10;
constexpr double kNotInUse = -1000000.0;
constexpr double kEarth_m = 6378145.0;  // of ROSflight 2.x

float standard_density(float altitude_m) {
  const auto& air = base::kRosflightTroposphere;
  const double share = 1.0 - static_cast<double>(altitude_m) / air.scale_m;
  return static_cast<float>(base::kSeaLevelDensity_kg_m3 *
                            std::pow(share, air.pressure_exponent * air.density_exponent));
}

}  // namespace

EstimatorInterface::EstimatorInterface(const rclcpp::NodeOptions& options)
    : Node("estimator", options) {
  declare();
  handle_ = params_.watch([this] { parameter_changed = true; });
  set_sensor_monitoring();
  subscribe<rosflight_msgs::msg::Status>("status", rclcpp::QoS(kDepth));
  subscribe<sensor_msgs::msg::Imu>("imu/data", stream(kDepth));
  subscribe<rosflight_msgs::msg::GNSS>("gnss", stream(kDepth));
  subscribe<rosflight_msgs::msg::Barometer>("baro", stream(kDepth));
  subscribe<sensor_msgs::msg::MagneticField>("magnetometer", stream(kDepth));
}

void EstimatorInterface::declare() {
  rate_handle_ = params_.declare_rate("estimator_update_frequency", 390.0, 1.0, update_);
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

template <class Message>
void EstimatorInterface::subscribe(const char* topic, const rclcpp::QoS& qos) {
  subscriptions_.push_back(create_subscription<Message>(
      topic, qos, [this](typename Message::ConstSharedPtr m) { take(*m); }));
}

void EstimatorInterface::check_sensors() {
  constexpr int kInterval_ms = 1000;
  for (const auto& [name, time] : time_since_last_sensor_update_) {
    const auto allowed_ms = params_.get_int("max_" + name + "_sensor_silence_duration_ms");
    const double silent_ms = 1e3 * (now() - time).seconds();
    if (silent_ms > static_cast<double>(allowed_ms))
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), kInterval_ms,
                           "%s: silent for %.0f ms, allowed %ld ms", name.c_str(), silent_ms,
                           static_cast<long>(allowed_ms));
  }
}

void EstimatorInterface::set_sensor_monitoring() {
  for (const char* name : {"imu", "mag", "baro", "gnss"}) received(name);
}

void EstimatorInterface::take(const rosflight_msgs::msg::Status& message) {
  input_.status_armed = message.armed;
  input_.armed_init = input_.armed_init || message.armed;
}

void EstimatorInterface::take(const sensor_msgs::msg::MagneticField& message) {
  received("mag");
  input_.mag_new = true;
  input_.mag_x = static_cast<float>(message.magnetic_field.x);
  input_.mag_y = static_cast<float>(message.magnetic_field.y);
  input_.mag_z = static_cast<float>(message.magnetic_field.z);
}

void EstimatorInterface::take(const sensor_msgs::msg::Imu& message) {
  received("imu");
  input_.accel_x = static_cast<float>(message.linear_acceleration.x);
  input_.accel_y = static_cast<float>(message.linear_acceleration.y);
  input_.accel_z = static_cast<float>(message.linear_acceleration.z);
  input_.gyro_x = static_cast<float>(message.angular_velocity.x);
  input_.gyro_y = static_cast<float>(message.angular_velocity.y);
  input_.gyro_z = static_cast<float>(message.angular_velocity.z);
  if (!input_.armed_init || !update_.at(nanoseconds(message.header.stamp))) return;
  step(message.header.stamp, input_);
  input_.gps_new = input_.mag_new = input_.baro_new = input_.diff_new = false;
}

void EstimatorInterface::take(const rosflight_msgs::msg::GNSS& message) {
  received("gnss");
  has_fix_ = message.fix_type >= params_.get_int("min_gnss_fix_type") &&
             std::isfinite(message.lat) && std::isfinite(message.lon);
  if (!has_fix_) return;
  if (!gps_init_) {
    set_origin(message);
    return;
  }
  input_.gps_lat = message.lat;
  input_.gps_lon = message.lon;
  input_.gps_alt = static_cast<double>(message.alt);
  const double north_rad = (message.lat - init_lat_) * base::kRadPerDeg;
  const double east_rad = (message.lon - init_lon_) * base::kRadPerDeg;
  input_.gps_n = static_cast<float>(kEarth_m * north_rad);
  input_.gps_e = static_cast<float>(kEarth_m * std::cos(init_lat_ * base::kRadPerDeg) * east_rad);
  input_.gps_h = message.alt - init_alt_;
  input_.gps_vn = message.vel_n;
  input_.gps_ve = message.vel_e;
  input_.gps_vd = message.vel_d;
  input_.gps_vg = std::hypot(message.vel_n, message.vel_e);
  if (static_cast<double>(input_.gps_vg) > params_.get_double("gps_ground_speed_threshold"))
    input_.gps_course = std::atan2(message.vel_e, message.vel_n);
  set_date(message);
  input_.gps_new = true;
}

void EstimatorInterface::set_origin(const rosflight_msgs::msg::GNSS& fix) {
  gps_init_ = true;
  init_lat_ = fix.lat;
  init_lon_ = fix.lon;
  init_alt_ = fix.alt;
  const auto given = static_cast<float>(params_.get_double("rho"));
  rho_ = given > 0.0F ? given : standard_density(init_alt_);
}

void EstimatorInterface::set_date(const rosflight_msgs::msg::GNSS& fix) {
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

void EstimatorInterface::take(const rosflight_msgs::msg::Barometer& message) {
  received("baro");
  if (!std::isfinite(message.pressure)) return;
  if (!baro_init_) {
    if (input_.armed_init) calibrate(message.pressure);
    return;
  }
  input_.baro_new = true;
  const float change_Pa = init_static_ - message.pressure;
  if (!gps_init_) {  // no density yet, so no gate
    input_.static_pres = change_Pa;
    return;
  }
  const auto gate_Pa =
      static_cast<float>(params_.get_double("baro_measurement_gate") * static_cast<double>(rho_) *
                         params_.get_double("gravity"));
  input_.static_pres =
      std::clamp(change_Pa, input_.static_pres - gate_Pa, input_.static_pres + gate_Pa);
}

void EstimatorInterface::calibrate(float pressure_Pa) {
  pressures_.push_back(pressure_Pa);
  const auto count = static_cast<std::size_t>(
      std::max<std::int64_t>(4, params_.get_int("baro_calibration_count")));
  if (pressures_.size() < count) return;
  std::sort(pressures_.begin(), pressures_.end());
  const float low = pressures_[count / 4];
  const float high = pressures_[3 * count / 4];
  const float margin = 2.0F * (high - low);
  baro_init_ = pressures_.front() >= low - margin && pressures_.back() <= high + margin;
  double sum = 0.0;
  for (const float pressure : pressures_) sum += static_cast<double>(pressure);
  init_static_ = static_cast<float>(sum / static_cast<double>(count));
  pressures_.clear();
  if (!baro_init_)
    RCLCPP_WARN(get_logger(),
                "baro: one sample of %zu is far from the others; calibration starts again", count);
}

}  // namespace rosflight_common
