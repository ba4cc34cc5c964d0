// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <array>
#include <builtin_interfaces/msg/time.hpp>
#include <cmath>
#include <cstdint>
#include <geometry_msgs/msg/pose.hpp>
#include <geometry_msgs/msg/quaternion.hpp>
#include <geometry_msgs/msg/vector3.hpp>
#include <geometry_msgs/msg/wrench.hpp>
#include <rosflight_msgs/msg/airspeed.hpp>
#include <rosflight_msgs/msg/barometer.hpp>
#include <rosflight_msgs/msg/battery_status.hpp>
#include <rosflight_msgs/msg/gnss.hpp>
#include <rosflight_msgs/msg/pwm_output.hpp>
#include <rosflight_msgs/msg/rc_raw.hpp>
#include <rosflight_msgs/msg/sim_state.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <sensor_msgs/msg/magnetic_field.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <sensor_msgs/msg/temperature.hpp>

#include "sim/types.hpp"

/// Our structs <-> ROS messages. SI and NED/FRD on both sides, as ROSflight 2.x has them, except
/// where a message says otherwise: temperatures of sensor_msgs are in degrees Celsius. The one
/// place of the simulator's nodes that knows fields of messages. Headers (stamp, frame) are filled
/// by the nodes.
namespace rosflight::ros_sim {

inline constexpr double kZeroCelsius_K = 273.15;

// ---- time, vectors, rotations -------------------------------------------------------------------

inline std::int64_t nanoseconds(const builtin_interfaces::msg::Time& stamp) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  return static_cast<std::int64_t>(stamp.sec) * kPerSecond + stamp.nanosec;
}

inline builtin_interfaces::msg::Time stamp_of(std::int64_t nanoseconds) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  builtin_interfaces::msg::Time stamp;
  const std::int64_t t = std::max<std::int64_t>(nanoseconds, 0);
  stamp.sec = static_cast<std::int32_t>(t / kPerSecond);
  stamp.nanosec = static_cast<std::uint32_t>(t % kPerSecond);
  return stamp;
}

template <class Message>  // Vector3 or Point
void put(const sim::Vector3& v, Message& message) {
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
}

inline void put(const hal::Vec3& v, geometry_msgs::msg::Vector3& message) {
  message.x = static_cast<double>(v[0]);
  message.y = static_cast<double>(v[1]);
  message.z = static_cast<double>(v[2]);
}

inline void put(const sim::Quaternion& q, geometry_msgs::msg::Quaternion& message) {
  message.w = q.w();
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
}

template <class Message>  // Vector3 or Point
sim::Vector3 vector(const Message& message) {
  return {message.x, message.y, message.z};
}

inline sim::Quaternion quaternion(const geometry_msgs::msg::Quaternion& message) {
  return {message.w, message.x, message.y, message.z};
}

inline hal::Vec3 floats(const geometry_msgs::msg::Vector3& message) {
  return {static_cast<float>(message.x), static_cast<float>(message.y),
          static_cast<float>(message.z)};
}

// ---- truth --------------------------------------------------------------------------------------

/// Acceleration: the inertial one in body axes (gravity and ground included, without w x v), and
/// the derivative of the body rate.
inline void put(const sim::Truth& truth, double gravity_m_s2, rosflight_msgs::msg::SimState& m) {
  const sim::BodyState& body = truth.body;
  put(body.p_N, m.pose.position);
  put(body.q_NB, m.pose.orientation);
  put(body.v_B, m.twist.linear);
  put(body.w_B, m.twist.angular);
  const sim::Vector3 gravity_B = body.q_NB.conjugate() * sim::Vector3(0.0, 0.0, gravity_m_s2);
  put(sim::Vector3(truth.specific_force_B + gravity_B), m.acceleration.linear);
  put(truth.angular_acceleration_B, m.acceleration.angular);
}

inline sim::BodyState body_state(const rosflight_msgs::msg::SimState& m) {
  sim::BodyState body;
  body.p_N = vector(m.pose.position);
  body.q_NB = quaternion(m.pose.orientation);
  body.v_B = vector(m.twist.linear);
  body.w_B = vector(m.twist.angular);
  return body;
}

/// Motion and accelerations of a truth; the rest of it stays. @returns false, with nothing changed,
/// for a message with a NaN or a quaternion that is none: other people's nodes send this.
inline bool get(const rosflight_msgs::msg::SimState& m, double gravity_m_s2, sim::Truth& truth) {
  sim::BodyState body = body_state(m);
  const sim::Vector3 acceleration = vector(m.acceleration.linear);
  const sim::Vector3 angular = vector(m.acceleration.angular);
  constexpr double kUnitTolerance = 1e-2;
  const double norm = body.q_NB.norm();
  if (!body.p_N.allFinite() || !body.v_B.allFinite() || !body.w_B.allFinite() ||
      !acceleration.allFinite() || !angular.allFinite() || !(std::abs(norm - 1.0) < kUnitTolerance))
    return false;
  body.q_NB.coeffs() /= norm;
  truth.body = body;
  truth.specific_force_B =
      acceleration - body.q_NB.conjugate() * sim::Vector3(0.0, 0.0, gravity_m_s2);
  truth.angular_acceleration_B = angular;
  return true;
}

inline void put(const sim::Wrench& wrench, geometry_msgs::msg::Wrench& m) {
  put(wrench.force_B, m.force);
  put(wrench.torque_B, m.torque);
}

/// @returns false, with nothing changed, if a number is not finite.
inline bool get(const geometry_msgs::msg::Wrench& m, sim::Wrench& wrench) {
  const sim::Wrench read{vector(m.force), vector(m.torque)};
  if (!read.force_B.allFinite() || !read.torque_B.allFinite()) return false;
  wrench = read;
  return true;
}

// ---- outputs and receiver -----------------------------------------------------------------------

inline constexpr double kLowestPulse_us = 1000.0;
inline constexpr double kPulseSpan_us = 1000.0;

/// 0..1 to 1000..2000 us, whole microseconds, rounded down as ROSflight does; a NaN is 1000.
inline std::uint16_t pulse_us(float value) {
  const double x = value > 0.0F ? std::min(static_cast<double>(value), 1.0) : 0.0;
  return static_cast<std::uint16_t>(kLowestPulse_us + std::floor(kPulseSpan_us * x + 1e-4));
}

inline float fraction(std::uint16_t pulse_us) {
  return static_cast<float>((static_cast<double>(pulse_us) - kLowestPulse_us) / kPulseSpan_us);
}

inline void put(const hal::OutputValues& outputs, rosflight_msgs::msg::PwmOutput& m) {
  for (std::size_t i = 0; i < outputs.size(); ++i) m.values[i] = pulse_us(outputs[i]);
}

/// Pulses beyond 1000..2000 are cut.
inline void get(const rosflight_msgs::msg::PwmOutput& m, hal::OutputValues& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i)
    outputs[i] = std::clamp(fraction(m.values[i]), 0.0F, 1.0F);
}

/// Pulses as they are: the firmware judges levels that no transmitter sends.
inline void get(const rosflight_msgs::msg::RCRaw& m, hal::RcFrame& frame) {
  for (std::size_t i = 0; i < m.values.size(); ++i) frame.channels[i] = fraction(m.values[i]);
  frame.channel_count = static_cast<std::uint8_t>(m.values.size());
  frame.frame_lost = frame.failsafe = false;
}

// ---- sensors ------------------------------------------------------------------------------------

inline void put(const hal::ImuSample& s, sensor_msgs::msg::Imu& imu,
                sensor_msgs::msg::Temperature& temperature) {
  put(s.accel_m_s2, imu.linear_acceleration);
  put(s.gyro_rad_s, imu.angular_velocity);
  imu.orientation_covariance[0] = -1.0;  // sensor_msgs/Imu: there is no orientation
  temperature.temperature = static_cast<double>(s.temperature_K) - kZeroCelsius_K;
}

inline void get(const sensor_msgs::msg::Imu& m, hal::ImuSample& s) {
  s.accel_m_s2 = floats(m.linear_acceleration);
  s.gyro_rad_s = floats(m.angular_velocity);
}

inline void put(const hal::MagSample& s, sensor_msgs::msg::MagneticField& m) {
  put(s.field_T, m.magnetic_field);
}

inline void get(const sensor_msgs::msg::MagneticField& m, hal::MagSample& s) {
  s.field_T = floats(m.magnetic_field);
}

inline void put(const hal::BaroSample& s, rosflight_msgs::msg::Barometer& m) {
  m.pressure = s.pressure_Pa;
  m.temperature = s.temperature_K;
}

inline void get(const rosflight_msgs::msg::Barometer& m, hal::BaroSample& s) {
  s.pressure_Pa = m.pressure;
  s.temperature_K = m.temperature;
}

inline void put(const hal::DiffPressureSample& s, rosflight_msgs::msg::Airspeed& m) {
  m.differential_pressure = s.pressure_Pa;
  m.temperature = s.temperature_K;
}

inline void get(const rosflight_msgs::msg::Airspeed& m, hal::DiffPressureSample& s) {
  s.pressure_Pa = m.differential_pressure;
  s.temperature_K = m.temperature;
}

/// Opening angles as `rosflight_io` reports them for the two kinds.
inline constexpr float kSonarView_rad = 1.0472F;
inline constexpr float kLidarView_rad = 0.0349066F;

inline void put(const hal::RangeSample& s, sensor_msgs::msg::Range& m) {
  const bool sonar = s.kind == hal::RangeKind::kSonar;
  m.radiation_type =
      sonar ? sensor_msgs::msg::Range::ULTRASOUND : sensor_msgs::msg::Range::INFRARED;
  m.field_of_view = sonar ? kSonarView_rad : kLidarView_rad;
  m.min_range = s.min_m;
  m.max_range = s.max_m;
  m.range = s.range_m;
}

inline void get(const sensor_msgs::msg::Range& m, hal::RangeSample& s) {
  s.kind = m.radiation_type == sensor_msgs::msg::Range::ULTRASOUND ? hal::RangeKind::kSonar
                                                                   : hal::RangeKind::kLidar;
  s.min_m = m.min_range;
  s.max_m = m.max_range;
  s.range_m = m.range;
}

inline void put(const hal::BatterySample& s, rosflight_msgs::msg::BatteryStatus& m) {
  m.voltage = s.voltage_V;
  m.current = s.current_A;
}

inline void get(const rosflight_msgs::msg::BatteryStatus& m, hal::BatterySample& s) {
  s.voltage_V = m.voltage;
  s.current_A = m.current;
}

inline void put(const hal::GnssSample& s, rosflight_msgs::msg::GNSS& m) {
  m.fix_type = static_cast<std::uint8_t>(s.fix);
  m.num_sat = s.satellites;
  m.lat = s.latitude_deg;
  m.lon = s.longitude_deg;
  m.alt = s.height_msl_m;
  m.horizontal_accuracy = s.horizontal_accuracy_m;
  m.vertical_accuracy = s.vertical_accuracy_m;
  m.vel_n = s.velocity_ned_m_s[0];
  m.vel_e = s.velocity_ned_m_s[1];
  m.vel_d = s.velocity_ned_m_s[2];
  m.speed_accuracy = s.speed_accuracy_m_s;
  m.gnss_unix_seconds = s.unix_s;
  m.gnss_unix_nanos = s.unix_ns;
}

/// A kind of fix that does not exist is none.
inline void get(const rosflight_msgs::msg::GNSS& m, hal::GnssSample& s) {
  constexpr auto kLast = static_cast<std::uint8_t>(hal::GnssFix::kTimeOnly);
  s.fix = m.fix_type <= kLast ? static_cast<hal::GnssFix>(m.fix_type) : hal::GnssFix::kNone;
  s.satellites = m.num_sat;
  s.latitude_deg = m.lat;
  s.longitude_deg = m.lon;
  s.height_msl_m = m.alt;
  s.horizontal_accuracy_m = m.horizontal_accuracy;
  s.vertical_accuracy_m = m.vertical_accuracy;
  s.velocity_ned_m_s = {m.vel_n, m.vel_e, m.vel_d};
  s.speed_accuracy_m_s = m.speed_accuracy;
  s.unix_s = m.gnss_unix_seconds;
  s.unix_ns = m.gnss_unix_nanos;
}

}  // namespace rosflight::ros_sim
