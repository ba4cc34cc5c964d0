// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rosflight_io {
namespace {

constexpr double kZeroCelsius_K = 273.15;

template <class In, class Out>
void set_xyz(const In& in, Out& out) {
  out.x = static_cast<double>(in[0]);
  out.y = static_cast<double>(in[1]);
  out.z = static_cast<double>(in[2]);
}

}  // namespace

void fill(const link::Imu& in, sensor_msgs::msg::Imu& out) {
  set_xyz(in.accel_m_s2, out.linear_acceleration);
  set_xyz(in.gyro_rad_s, out.angular_velocity);
}

void fill(const link::Imu& in, sensor_msgs::msg::Temperature& out) {
  out.temperature = static_cast<double>(in.temperature_K) - kZeroCelsius_K;
  out.variance = 0.0;
}

void fill(const link::Attitude& in, rosflight_msgs::msg::Attitude& out) {
  out.attitude.w = static_cast<double>(in.q_NB[0]);
  out.attitude.x = static_cast<double>(in.q_NB[1]);
  out.attitude.y = static_cast<double>(in.q_NB[2]);
  out.attitude.z = static_cast<double>(in.q_NB[3]);
  set_xyz(in.rates_rad_s, out.angular_velocity);
}

void fill(const link::Attitude& in, geometry_msgs::msg::Vector3Stamped& out) {
  const double w = static_cast<double>(in.q_NB[0]);
  const double x = static_cast<double>(in.q_NB[1]);
  const double y = static_cast<double>(in.q_NB[2]);
  const double z = static_cast<double>(in.q_NB[3]);
  out.vector.x = std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
  out.vector.y = std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0));
  out.vector.z = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
}

void fill(const link::Mag& in, sensor_msgs::msg::MagneticField& out) {
  set_xyz(in.field_T, out.magnetic_field);
}

void fill(const link::Baro& in, rosflight_msgs::msg::Barometer& out) {
  out.altitude = in.altitude_m;
  out.pressure = in.pressure_Pa;
  out.temperature = in.temperature_K;
}

void fill(const link::DiffPressure& in, rosflight_msgs::msg::Airspeed& out) {
  out.velocity = in.airspeed_m_s;
  out.differential_pressure = in.pressure_Pa;
  out.temperature = in.temperature_K;
}

void fill(const link::Range& in, sensor_msgs::msg::Range& out) {
  constexpr float kSonarView_rad = 1.0472F;
  constexpr float kLidarView_rad = 0.0349066F;
  const bool lidar = in.kind == 1;
  out.radiation_type =
      lidar ? sensor_msgs::msg::Range::INFRARED : sensor_msgs::msg::Range::ULTRASOUND;
  out.field_of_view = lidar ? kLidarView_rad : kSonarView_rad;
  out.min_range = in.min_m;
  out.max_range = in.max_m;
  out.range = in.range_m;
}

void fill(const link::RcChannels& in, rosflight_msgs::msg::RCRaw& out) {
  std::copy_n(in.pulse_us.begin(), out.values.size(), out.values.begin());
}

void fill(const link::OutputRaw& in, rosflight_msgs::msg::OutputRaw& out) {
  out.values = in.values;
}

void fill(const link::Gnss& in, rosflight_msgs::msg::GNSS& out) {
  out.fix_type = in.fix;
  out.num_sat = in.satellites;
  out.lat = in.latitude_deg;
  out.lon = in.longitude_deg;
  out.alt = in.height_msl_m;
  out.horizontal_accuracy = in.horizontal_accuracy_m;
  out.vertical_accuracy = in.vertical_accuracy_m;
  out.vel_n = in.velocity_ned_m_s[0];
  out.vel_e = in.velocity_ned_m_s[1];
  out.vel_d = in.velocity_ned_m_s[2];
  out.speed_accuracy = in.speed_accuracy_m_s;
  out.gnss_unix_seconds = in.unix_s;
  out.gnss_unix_nanos = in.unix_ns;
}

void fill(const link::BatteryStatus& in, rosflight_msgs::msg::BatteryStatus& out) {
  out.voltage = in.voltage_V;
  out.current = in.current_A;
}

void fill(const link::Status& in, rosflight_msgs::msg::Status& out) {
  out.armed = in.armed;
  out.failsafe = in.failsafe;
  out.rc_override = in.rc_override;
  out.offboard = in.offboard;
  out.control_mode = in.control_mode;
  out.error_code = in.error_code;
  out.num_errors = in.sensor_errors;
  out.loop_time_us = in.loop_time_us;
}

void fill(const link::HardError& in, rosflight_msgs::msg::Error& out) {
  out.error_message = "The flight controller had a fault and restarted";
  out.error_code = in.error_code;
  out.reset_count = in.reset_count;
  out.rearm = in.rearm != 0;
  out.pc = in.pc;
}

link::OffboardControl to_link(const rosflight_msgs::msg::Command& in) {
  return {in.mode, in.ignore, in.u};
}

link::AuxCommand to_link(const rosflight_msgs::msg::AuxCommand& in) {
  return {in.type_array, in.values};
}

link::ExternalAttitude to_link(const rosflight_msgs::msg::Attitude& in) {
  return {{static_cast<float>(in.attitude.w), static_cast<float>(in.attitude.x),
           static_cast<float>(in.attitude.y), static_cast<float>(in.attitude.z)}};
}

const char* error_text(int bit) {
  constexpr std::array<const char*, 8> kTexts{
      "invalid mixer",        "IMU not responding", "RC lost",        "unhealthy estimator",
      "time going backwards", "IMU uncalibrated",   "buffer overrun", "invalid failsafe throttle"};
  return bit >= 0 && bit < static_cast<int>(kTexts.size()) ? kTexts[static_cast<std::size_t>(bit)]
                                                           : nullptr;
}

const char* control_mode_text(int mode) {
  switch (mode) {
    case 0:
      return "pass-through";
    case 1:
      return "rate";
    case 2:
      return "angle";
    default:
      return "unknown";
  }
}

}  // namespace rosflight_io
