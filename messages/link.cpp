// SPDX-License-Identifier: BSD-3-Clause
#include "messages/link.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "messages/fill.hpp"
#include "messages/utf8.hpp"

namespace rosflight::messages {
namespace {

template <std::size_t kLength>
std::string fixed_text(const std::array<char, kLength>& text) {
  return clean_utf8({text.data(), kLength});
}

/// ROS quaternions end with the scalar, ours begin with it.
geometry_msgs::Quaternion quaternion(const std::array<float, 4>& q) {
  return {static_cast<double>(q[1]), static_cast<double>(q[2]), static_cast<double>(q[3]),
          static_cast<double>(q[0])};
}

double parameter_value(std::uint8_t type, link::ParamBits value) {
  if (type == static_cast<std::uint8_t>(link::ParamType::kInt32)) {
    return static_cast<double>(static_cast<std::int32_t>(value.bits));
  }
  if (type == static_cast<std::uint8_t>(link::ParamType::kFloat)) {
    return static_cast<double>(std::bit_cast<float>(value.bits));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

builtin_interfaces::Time stamp_of(std::uint64_t time_ns) {
  constexpr std::uint64_t kPerSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(time_ns / kPerSecond),
          static_cast<std::uint32_t>(time_ns % kPerSecond)};
}

std::array<double, 3> euler_angles(const std::array<float, 4>& q_WB) {
  const auto [x, y, z, w] = quaternion(q_WB);
  return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)),
          std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

// ---- FCU to companion

sensor_msgs::Imu to_message(const link::Imu& in) {
  sensor_msgs::Imu out;
  out.orientation_covariance[0] = -1.0;  // sensor_msgs/Imu: there is no orientation
  fill(in.accel_m_s2, out.linear_acceleration);
  fill(in.gyro_rad_s, out.angular_velocity);
  return out;
}

sensor_msgs::Imu to_message(const link::Imu& in, const link::Attitude& latest) {
  sensor_msgs::Imu out = to_message(in);
  out.orientation = quaternion(latest.q_WB);
  out.orientation_covariance[0] = 0.0;
  return out;
}

sensor_msgs::Temperature imu_temperature(const link::Imu& in) {
  sensor_msgs::Temperature out;
  out.temperature = static_cast<double>(in.temperature_K) - kZeroCelsius_K;
  return out;
}

rosflight_msgs::Attitude to_message(const link::Attitude& in) {
  rosflight_msgs::Attitude out;
  out.attitude = quaternion(in.q_WB);
  fill(in.rates_rad_s, out.angular_velocity);
  return out;
}

geometry_msgs::Vector3Stamped euler_message(const link::Attitude& in) {
  geometry_msgs::Vector3Stamped out;
  fill(euler_angles(in.q_WB), out.vector);
  return out;
}

sensor_msgs::MagneticField to_message(const link::Mag& in) {
  sensor_msgs::MagneticField out;
  fill(in.field_T, out.magnetic_field);
  return out;
}

rosflight_msgs::Barometer to_message(const link::Baro& in) {
  return {{}, in.altitude_m, in.pressure_Pa, in.temperature_K};
}

rosflight_msgs::Airspeed to_message(const link::DiffPressure& in) {
  return {{}, in.airspeed_m_s, in.pressure_Pa, in.temperature_K};
}

sensor_msgs::Range to_message(const link::Range& in) {
  constexpr std::uint8_t kLidar = 1;
  return range_message(in.kind == kLidar, in.min_m, in.max_m, in.range_m);
}

rosflight_msgs::RCRaw to_message(const link::RcChannels& in) {
  rosflight_msgs::RCRaw out;
  std::copy_n(in.pulse_us.begin(), out.values.size(), out.values.begin());
  return out;
}

rosflight_msgs::OutputRaw to_message(const link::OutputRaw& in) {
  return {{}, in.values};
}

rosflight_msgs::Status to_message(const link::Status& in) {
  rosflight_msgs::Status out;
  out.armed = in.armed;
  out.failsafe = in.failsafe;
  out.rc_override = in.rc_override;
  out.offboard = in.offboard;
  out.control_mode = in.control_mode;
  out.error_code = in.error_code;
  out.num_errors = in.sensor_errors;
  out.loop_time_us = in.loop_time_us;
  return out;
}

rosflight_msgs::Error to_message(const link::HardError& in) {
  rosflight_msgs::Error out;
  out.error_message = "The flight controller had a fault and restarted";
  out.error_code = in.error_code;
  out.reset_count = in.reset_count;
  out.rearm = in.rearm != 0;
  out.pc = in.pc;
  return out;
}

rosflight_msgs::GNSS to_message(const link::Gnss& in) {
  rosflight_msgs::GNSS out;
  fill_gnss(in, out);
  out.fix_type = in.fix;
  return out;
}

rosflight_msgs::BatteryStatus to_message(const link::BatteryStatus& in) {
  return {{}, in.voltage_V, in.current_A};
}

std_msgs::String to_message(const link::Version& in) {
  return {fixed_text(in.text)};
}

rcl_interfaces::Log to_message(link::Severity severity, std::string_view name,
                               std::string_view text) {
  using rcl_interfaces::Log;
  Log out;
  out.level = Log::INFO;
  if (severity == link::Severity::kWarning) out.level = Log::WARN;
  if (severity == link::Severity::kError) out.level = Log::ERROR;
  if (severity == link::Severity::kCritical) out.level = Log::FATAL;
  out.name = clean_utf8(name);
  out.msg = clean_utf8(text);
  return out;
}

// ---- companion to FCU

rosflight_msgs::Command to_message(const link::OffboardControl& in) {
  rosflight_msgs::Command out;
  out.mode = in.mode;
  out.ignore = in.ignore;
  out.u = in.u;
  return out;
}

rosflight_msgs::AuxCommand to_message(const link::AuxCommand& in) {
  rosflight_msgs::AuxCommand out;
  out.type_array = in.type;
  out.values = in.value;
  return out;
}

rosflight_msgs::Attitude to_message(const link::ExternalAttitude& in) {
  rosflight_msgs::Attitude out;
  out.attitude = quaternion(in.q_WB);
  return out;
}

link::OffboardControl to_link(const rosflight_msgs::Command& in) {
  return {in.mode, in.ignore, in.u};
}

link::AuxCommand to_link(const rosflight_msgs::AuxCommand& in) {
  return {in.type_array, in.values};
}

link::ExternalAttitude to_link(const rosflight_msgs::Attitude& in) {
  const geometry_msgs::Quaternion& q = in.attitude;
  return {{static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
           static_cast<float>(q.z)}};
}

// ---- link traffic that ROSflight has no message for

rosflight_log_msgs::Heartbeat to_message(const link::Heartbeat& in) {
  rosflight_log_msgs::Heartbeat out;
  out.vehicle_type = static_cast<std::uint8_t>(in.type);
  return out;
}

rosflight_log_msgs::TimeSync to_message(const link::TimeSync& in) {
  rosflight_log_msgs::TimeSync out;
  out.tc1 = in.tc1_ns;
  out.ts1 = in.ts1_ns;
  return out;
}

rosflight_log_msgs::ParamRequestRead to_message(const link::ParamRequestRead& in) {
  return {{}, in.target_system, in.index, fixed_text(in.name)};
}

rosflight_log_msgs::ParamRequestList to_message(const link::ParamRequestList& in) {
  return {{}, in.target_system};
}

rosflight_log_msgs::ParamSet to_message(const link::ParamSet& in) {
  rosflight_log_msgs::ParamSet out;
  out.target_system = in.target_system;
  out.name = fixed_text(in.name);
  out.type = in.type;
  out.value = parameter_value(in.type, in.value);
  out.bits = in.value.bits;
  return out;
}

rosflight_log_msgs::ParamValue to_message(const link::ParamValue& in) {
  rosflight_log_msgs::ParamValue out;
  out.name = fixed_text(in.name);
  out.type = static_cast<std::uint8_t>(in.type);
  out.value = parameter_value(out.type, in.value);
  out.bits = in.value.bits;
  out.index = in.index;
  out.count = in.count;
  return out;
}

rosflight_log_msgs::CommandRequest to_message(const link::CommandRequest& in) {
  return {{}, in.command};
}

rosflight_log_msgs::CommandAck to_message(const link::CommandAck& in) {
  return {{}, in.command, in.success};
}

rosflight_log_msgs::MotorTest to_message(const link::MotorTest& in) {
  return {{}, in.target_system, in.motor, in.value};
}

rosflight_log_msgs::ReportRequest to_message(const link::ReportRequest& in) {
  return {{}, in.target_system, in.kind};
}

rosflight_log_msgs::CheckResult to_message(const link::CheckResult& in) {
  return {{}, in.index, in.count, in.result, fixed_text(in.name), fixed_text(in.reason)};
}

rosflight_log_msgs::Counters to_message(const link::Counters& in) {
  rosflight_log_msgs::Counters out;
  out.longest_pass = in.longest_pass_us;
  out.pass_budget = in.pass_budget_us;
  out.passes_over_budget = in.passes_over_budget;
  out.passes = in.passes;
  out.frames_dropped = in.frames_dropped;
  out.tx_dropped = in.tx_dropped;
  out.texts_lost = in.texts_lost;
  out.imu_jitter = in.imu_jitter;
  out.rejected = in.rejected;
  return out;
}

rosflight_log_msgs::Parameter to_message(std::string_view name, link::ParamType type,
                                         link::ParamBits value) {
  rosflight_log_msgs::Parameter out;
  out.name = clean_utf8(name);
  out.type = static_cast<std::uint8_t>(type);
  out.value = parameter_value(out.type, value);
  return out;
}

}  // namespace rosflight::messages
