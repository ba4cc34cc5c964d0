// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "messages/rosflight_msgs.hpp"
#include "messages/sensor_msgs.hpp"

/// What the conversions of link structs and of samples share. Private to this folder.
namespace rosflight::messages {

inline constexpr double kZeroCelsius_K = 273.15;

/// @param out  Vector3 or Point.
template <class In, class Out>
void fill(const In& in, Out& out) {
  out.x = static_cast<double>(in[0]);
  out.y = static_cast<double>(in[1]);
  out.z = static_cast<double>(in[2]);
}

/// Opening angles are those that ROSflight 2.x publishes for the two kinds.
inline sensor_msgs::Range range_message(bool lidar, float min_m, float max_m, float range_m) {
  constexpr float kSonarView_rad = 1.0472F;
  constexpr float kLidarView_rad = 0.0349066F;
  sensor_msgs::Range out;
  out.radiation_type = lidar ? sensor_msgs::Range::INFRARED : sensor_msgs::Range::ULTRASOUND;
  out.field_of_view = lidar ? kLidarView_rad : kSonarView_rad;
  out.min_range = min_m;
  out.max_range = max_m;
  out.range = range_m;
  return out;
}

/// All but the kind of fix, whose type differs. @param in  a link::Gnss or a hal::GnssSample.
template <class In>
void fill_gnss(const In& in, rosflight_msgs::GNSS& out) {
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

}  // namespace rosflight::messages
